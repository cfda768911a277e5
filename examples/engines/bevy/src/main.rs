//! An endless world that is dug, in Bevy.
//!
//! `cargo run --release --manifest-path examples/engines/Cargo.toml --target-dir target/engines --package isostudy-bevy-world`
//!
//! W, A, S and D fly; the mouse looks round while its right button is down; Space digs.

use std::collections::HashMap;
use std::f32::consts::FRAC_PI_2;

use bevy::asset::RenderAssetUsages;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::input::mouse::AccumulatedMouseMotion;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use isostudy_world::{ChunkMesh, Ground, Hole, Id, World as Chunks};

/// Metres a second.
const SPEED: f32 = 20.0;
/// Radians a pixel.
const TURN: f32 = 0.003;
/// How far ahead is dug, and how wide.
const REACH: f32 = 14.0;
const RADIUS: f32 = 4.0;

fn main() -> AppExit {
    App::new()
        .add_plugins(DefaultPlugins)
        .insert_resource(ClearColor(Color::srgb(0.55, 0.7, 0.9)))
        .add_systems(Startup, set_up)
        .add_systems(Update, (fly, dig, stream).chain())
        .run()
}

/// The thread that makes chunks, and the chunks that Bevy draws.
struct Terrain {
    chunks: Chunks,
    material: Handle<StandardMaterial>,
    drawn: HashMap<Id, Entity>,
}

/// From the world's z, which is up, to Bevy's y.
fn turned() -> Quat {
    Quat::from_rotation_x(-FRAC_PI_2)
}

fn set_up(world: &mut World) {
    let material = StandardMaterial {
        base_color: Color::srgb(0.36, 0.45, 0.22),
        perceptual_roughness: 0.95,
        ..default()
    };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    let chunks = match Chunks::new() {
        Ok(chunks) => chunks,
        Err(error) => {
            eprintln!("no thread for chunks: {error}");
            world.write_message(AppExit::error());
            return;
        }
    };
    world.insert_non_send(Terrain { chunks, material, drawn: HashMap::new() });
    let eye = turned() * Vec3::new(0.0, 0.0, Ground::default().height(0.0, 0.0) + 12.0);
    world.spawn((
        Camera3d::default(),
        // The default reads a table that a feature of Bevy has: without it all is magenta.
        Tonemapping::AcesFitted,
        Transform::from_translation(eye).looking_to(Vec3::new(1.0, -0.3, 0.4), Vec3::Y),
    ));
    world.spawn((
        DirectionalLight { illuminance: 9_000.0, ..default() },
        Transform::default().looking_to(Vec3::new(-0.4, -0.75, -0.5), Vec3::Y),
    ));
}

fn fly(
    keys: Res<ButtonInput<KeyCode>>,
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    time: Res<Time>,
    mut camera: Single<&mut Transform, With<Camera3d>>,
) {
    if buttons.pressed(MouseButton::Right) {
        camera.rotate_y(-TURN * motion.delta.x);
        camera.rotate_local_x(-TURN * motion.delta.y);
    }
    let axis =
        |more: KeyCode, less: KeyCode| f32::from(i8::from(keys.pressed(more)) - i8::from(keys.pressed(less)));
    let way = camera.forward() * axis(KeyCode::KeyW, KeyCode::KeyS)
        + camera.right() * axis(KeyCode::KeyD, KeyCode::KeyA);
    camera.translation += SPEED * time.delta_secs() * way;
}

fn dig(
    keys: Res<ButtonInput<KeyCode>>,
    terrain: Option<NonSend<Terrain>>,
    camera: Single<&Transform, With<Camera3d>>,
) {
    if let Some(terrain) = terrain
        && keys.just_pressed(KeyCode::Space)
    {
        let there = camera.translation + REACH * camera.forward();
        terrain.chunks.dig(Hole { centre: (turned().inverse() * there).to_array(), radius: RADIUS });
    }
}

/// Tells where the camera is, and takes what has been made: all of a set in one frame, so that there are no cracks.
fn stream(
    mut commands: Commands,
    terrain: Option<NonSendMut<Terrain>>,
    mut meshes: ResMut<Assets<Mesh>>,
    camera: Single<&Transform, With<Camera3d>>,
) {
    let Some(mut terrain) = terrain else { return };
    let Terrain { chunks, material, drawn } = &mut *terrain;
    chunks.go((turned().inverse() * camera.translation).to_array());
    for changes in chunks.changes() {
        for id in changes.gone {
            if let Some(entity) = drawn.remove(&id) {
                commands.entity(entity).despawn();
            }
        }
        for (id, chunk) in changes.made {
            let place =
                Transform::from_translation(turned() * Vec3::from(chunk.origin)).with_rotation(turned());
            let made = commands
                .spawn((Mesh3d(meshes.add(mesh(chunk))), MeshMaterial3d(material.clone()), place))
                .id();
            if let Some(before) = drawn.insert(id, made) {
                commands.entity(before).despawn();
            }
        }
    }
}

/// The buffers as they are.
fn mesh(chunk: ChunkMesh) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, chunk.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, chunk.normals)
        .with_inserted_indices(Indices::U32(chunk.indices))
}
