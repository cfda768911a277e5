//! Files of points damaged in every way: no panic, no memory beyond the file's size, and what is read all the same makes a field or an
//! error. The fields of damaged meshes too.

#[path = "../../../../tests/damage.rs"]
mod damage;

use damage::damage;
use isostudy_field::StudyField;
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::read_obj;
use isostudy_scattered::{PointField, PointFormat, PointSettings, SoupField, read_points};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const ROUNDS: u64 = 5000;
/// What breaks readers.
const TOKENS: [&[u8]; 20] = [
    b"\0",
    b"\n",
    b"\r",
    b" ",
    b"-1",
    b"0",
    b"1e39",
    b"nan",
    b"inf",
    b"-",
    b",",
    b";",
    b"#",
    b"v ",
    b"vn 0 0 1\n",
    b"f 1 2 3\n",
    b"\xff\xff",
    b"\xef\xbb\xbf",
    b"1e-45",
    b"99999999999999999999",
];

fn rows() -> Vec<[f32; 6]> {
    let row = |i: usize| {
        let (turn, z) = (2.4 * i as f32, 0.8 - 0.2 * i as f32);
        let p = Vec3::new(turn.cos(), turn.sin(), z);
        let n = p.normalize();
        [p.x, p.y, p.z, n.x, n.y, n.z]
    };
    (0..9).map(row).collect()
}

fn sound(format: PointFormat) -> Vec<u8> {
    let words = |values: &[f32]| values.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
    let rows = rows();
    let text: String = match format {
        PointFormat::Xyz => rows.iter().map(|row| words(row) + "\n").collect(),
        PointFormat::Obj => {
            rows.iter().map(|row| format!("v {}\nvn {}\n", words(&row[..3]), words(&row[3..]))).collect()
        }
        PointFormat::Ply => {
            let names =
                ["x", "y", "z", "nx", "ny", "nz"].map(|name| format!("property float {name}\n")).concat();
            let header = format!("ply\nformat ascii 1.0\nelement vertex {}\n{names}end_header\n", rows.len());
            header + &rows.iter().map(|row| words(row) + "\n").collect::<String>()
        }
    };
    text.into_bytes()
}

#[test]
fn damaged_files_of_points_are_refused_or_make_a_field() {
    for (number, format) in PointFormat::ALL.into_iter().enumerate() {
        let (mut read, mut refused, mut fields) = (0, 0, 0);
        for round in 0..ROUNDS {
            let mut random = Pcg64::seed_from_u64(1000 * ROUNDS * number as u64 + round);
            let mut bytes = sound(format);
            damage(&mut bytes, &TOKENS, [4, 60], &mut random);
            let cloud = match read_points(format, &bytes[..]) {
                Ok(cloud) => cloud,
                Err(error) => {
                    assert!(error.to_string().len() < 300, "{format:?}, round {round}: {error}");
                    refused += 1;
                    continue;
                }
            };
            read += 1;
            let points = cloud.positions.len();
            assert!(points <= bytes.len() && cloud.positions.iter().all(|p| p.is_finite()));
            assert!(cloud.normals.is_empty() || cloud.normals.len() == points, "{format:?}, round {round}");
            assert!(cloud.lines.is_empty() || cloud.lines.len() == points, "{format:?}, round {round}");
            match PointField::try_new(&cloud, &PointSettings::default()) {
                Ok(field) => {
                    fields += 1;
                    assert!(!field.sample(Vec3::splat(0.25)).is_infinite(), "{format:?}, round {round}");
                }
                Err(error) => assert!(error.to_string().len() < 300, "{format:?}, round {round}: {error}"),
            }
        }
        println!("{format:?}: {read} of {ROUNDS} read, {refused} refused, {fields} fields");
        assert!(
            read > ROUNDS / 20 && refused > ROUNDS / 20 && fields > ROUNDS / 50,
            "{format:?}: {read}, {refused}, {fields}"
        );
    }
}

#[test]
fn damaged_soup_is_refused_or_makes_a_field() {
    let sound = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1.5 0.25 -3e-1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 2 3 5\n";
    let (mut fields, mut refused) = (0, 0);
    for round in 0..ROUNDS {
        let mut bytes = sound.to_vec();
        damage(&mut bytes, &TOKENS, [4, 60], &mut Pcg64::seed_from_u64(round));
        let Ok(mesh) = read_obj(&bytes[..]) else { continue };
        for epsilon in [Some(0.0), None] {
            match SoupField::try_new(&mesh, epsilon) {
                Ok(field) => {
                    fields += 1;
                    for p in [
                        Vec3::splat(0.1),
                        Vec3::ZERO,
                        Vec3::X,
                        Vec3::new(0.5, 0.5, 0.0),
                        Vec3::new(2.0, 0.0, 0.0),
                    ] {
                        assert!(field.sample(p).is_finite(), "round {round}: {} at {p}", field.sample(p));
                        assert!(field.gradient(p).is_none_or(|gradient| gradient.is_finite()));
                    }
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().len() < 300, "round {round}: {error}");
                }
            }
        }
    }
    assert!(fields > 500 && refused > 50, "{fields}, {refused}");
}
