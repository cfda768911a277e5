//! Chunks as buffers of a graphics card, and a picture of them.

use std::collections::HashMap;
use std::error::Error;
use std::mem::size_of;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use isostudy_world::{Changes, ChunkMesh, Id};
use wgpu::util::DeviceExt;

const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const SKY: wgpu::Color = wgpu::Color { r: 0.25, g: 0.45, b: 0.8, a: 1.0 };

/// Light from one side, and the sky's colour far away.
const SHADER: &str = "
struct Camera { view: mat4x4<f32>, eye: vec4<f32> }
@group(0) @binding(0) var<uniform> camera: Camera;

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) away: f32,
}

@vertex
fn vertex(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) origin: vec3<f32>) -> Corner {
    let world = origin + position;
    var corner: Corner;
    corner.place = camera.view * vec4<f32>(world, 1.0);
    corner.normal = normal;
    corner.away = distance(world, camera.eye.xyz);
    return corner;
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4<f32> {
    let normal = normalize(corner.normal);
    let light = 0.25 + 0.75 * max(dot(normal, normalize(vec3<f32>(0.4, -0.5, 0.75))), 0.0);
    let grass = mix(vec3<f32>(0.30, 0.22, 0.14), vec3<f32>(0.20, 0.34, 0.10), smoothstep(0.5, 0.8, normal.z));
    let sky = vec3<f32>(0.25, 0.45, 0.8);
    return vec4<f32>(mix(grass * light, sky, 0.8 * smoothstep(150.0, 420.0, corner.away)), 1.0);
}
";

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
}

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Camera {
    view: [[f32; 4]; 4],
    eye: [f32; 4],
}

/// A chunk on the card.
struct Drawn {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Its corner, as an attribute of an instance.
    origin: wgpu::Buffer,
    count: u32,
}

/// Draws into a picture of its own.
pub(crate) struct Painter {
    size: [u32; 2],
    adapter: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::RenderPipeline,
    camera: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    colour: wgpu::Texture,
    depth: wgpu::TextureView,
    chunks: HashMap<Id, Drawn>,
}

impl Painter {
    /// # Errors
    /// If there is no driver.
    pub(crate) fn new(size: [u32; 2]) -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let info = adapter.get_info();

        let camera = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("camera"),
            size: size_of::<Camera>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let pipeline = pipeline(&device);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
        });
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let colour = texture(COLOUR, wgpu::TextureUsages::COPY_SRC);
        let depth = texture(DEPTH, wgpu::TextureUsages::empty()).create_view(&Default::default());
        let adapter = format!("{} ({:?})", info.name, info.backend);
        Ok(Self {
            size,
            adapter,
            device,
            queue,
            pipeline,
            camera,
            bindings,
            colour,
            depth,
            chunks: HashMap::new(),
        })
    }

    /// Who draws.
    pub(crate) fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Of all chunks.
    pub(crate) fn triangles(&self) -> u32 {
        self.chunks.values().map(|chunk| chunk.count / 3).sum()
    }

    /// A set of changes as a whole, so that there are no cracks.
    pub(crate) fn apply(&mut self, changes: Changes) {
        for id in changes.gone {
            self.chunks.remove(&id);
        }
        for (id, mesh) in changes.made {
            let drawn = self.upload(&mesh);
            self.chunks.insert(id, drawn);
        }
    }

    fn upload(&self, mesh: &ChunkMesh) -> Drawn {
        let vertices: Vec<Vertex> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(&position, &normal)| Vertex { position, normal })
            .collect();
        let buffer = |contents: &[u8], usage| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        Drawn {
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
            origin: buffer(bytemuck::bytes_of(&mesh.origin), wgpu::BufferUsages::VERTEX),
            count: mesh.indices.len() as u32,
        }
    }

    /// Draws all chunks as they are seen from a place.
    pub(crate) fn draw(&self, eye: Vec3, ahead: Vec3) {
        let aspect = self.size[0] as f32 / self.size[1] as f32;
        let view = Mat4::perspective_rh(1.1, aspect, 0.1, 1000.0) * Mat4::look_at_rh(eye, ahead, Vec3::Z);
        let camera = Camera { view: view.to_cols_array_2d(), eye: eye.extend(1.0).to_array() };
        self.queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&camera));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let colour = self.colour.create_view(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(SKY), store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(1.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.bindings, &[]);
            for chunk in self.chunks.values() {
                pass.set_vertex_buffer(0, chunk.vertices.slice(..));
                pass.set_vertex_buffer(1, chunk.origin.slice(..));
                pass.set_index_buffer(chunk.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..chunk.count, 0, 0..1);
            }
        }
        self.queue.submit([encoder.finish()]);
    }

    /// The last picture, four bytes for each pixel, from above.
    pub(crate) fn pixels(&self) -> Result<Vec<u8>, Box<dyn Error>> {
        let [width, height] = self.size;
        // A row of a copy takes a multiple of 256 bytes.
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.colour.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            self.colour.size(),
        );
        self.queue.submit([encoder.finish()]);
        let (done, mapped) = std::sync::mpsc::channel();
        copy.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody waits any more only if the wait below failed.
            let _ = done.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        mapped.recv()??;
        let bytes = copy.get_mapped_range(..)?;
        Ok(bytes.chunks_exact(row as usize).flat_map(|row| &row[..4 * width as usize]).copied().collect())
    }
}

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let corners = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
    };
    let origin = wgpu::VertexBufferLayout {
        array_stride: size_of::<[f32; 3]>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![2 => Float32x3],
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[Some(corners), Some(origin)],
        },
        // Triangles are counter-clockwise seen from outside: those that show their back are left out.
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: Default::default(),
            targets: &[Some(COLOUR.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
