//! Marching cubes against VTK's Flying Edges on 20 volumes, where VTK is installed:
//! `pip install -r scripts/methods/requirements.txt`, and `METHODS_PYTHON` names that Python, `python3` if it is not set.
//!
//! VTK has a sample that equals the isovalue inside, so the level here is the next number below it: no sample is between.

use std::io::Write;
use std::process::{Command, Stdio};

use glam::Vec3;
use isostudy_extract::{Cubes, Execution, Extractor, Method, VolumeCells};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Reads counts, isovalue and samples, volume by volume; prints vertices and triangles of each.
const FLYING_EDGES: &str = r#"
import sys
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

while head := sys.stdin.buffer.read(16):
    counts = np.frombuffer(head[:12], "<i4")
    isovalue = float(np.frombuffer(head[12:], "<f4")[0])
    samples = np.frombuffer(sys.stdin.buffer.read(4 * int(counts.prod())), "<f4").copy()
    image = vtkImageData()
    image.SetDimensions(*map(int, counts))
    image.GetPointData().SetScalars(numpy_to_vtk(samples))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, isovalue)
    edges.Update()
    surface = edges.GetOutput()
    print(surface.GetNumberOfPoints(), surface.GetNumberOfPolys())
"#;

struct Volume {
    counts: [usize; 3],
    isovalue: f32,
    values: Vec<f32>,
}

impl Volume {
    fn new(counts: [usize; 3], isovalue: f32, mut value: impl FnMut(Vec3) -> f32) -> Self {
        let [nx, ny, _] = counts;
        let place = |i: usize| Vec3::from_array([i % nx, i / nx % ny, i / nx / ny].map(|x| x as f32));
        let values = (0..counts.iter().product()).map(|i| value(place(i))).collect();
        Self { counts, isovalue, values }
    }
}

/// Smooth, noisy and of whole numbers, which have levels on samples.
fn volumes() -> Vec<Volume> {
    let mut random = Pcg64Mcg::seed_from_u64(20);
    let mut all = Vec::new();
    for (i, counts) in
        [[20, 20, 20], [33, 17, 9], [2, 2, 2], [64, 5, 7], [41, 41, 41]].into_iter().enumerate()
    {
        let centre = Vec3::from_array(counts.map(|n| n as f32 / 2.0 - 0.37));
        all.push(Volume::new(counts, 0.0, |p| centre.min_element() * 0.8 - p.distance(centre)));
        all.push(Volume::new(counts, 0.1, |_| random.random_range(-1.0..1.0)));
        all.push(Volume::new(counts, 1.0 + i as f32, |_| random.random_range(0..8) as f32));
        // Marschner and Lobb's kind of ripples, as whole numbers.
        all.push(Volume::new(counts, 100.0, |p| {
            let q = (p - centre) / 20.0;
            let ripple = (19.0 * (1.57 * q.truncate().length()).cos()).cos();
            (255.0 * (1.0 - (1.57 * q.z).sin() + 0.25 * (1.0 + ripple)) / 2.5).floor()
        }));
    }
    all
}

#[test]
fn counts_are_those_of_flying_edges() {
    let python = std::env::var("METHODS_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let import = Command::new(&python).args(["-c", "import numpy, vtkmodules.vtkFiltersCore"]).output();
    if !import.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {python} has no numpy or no vtk");
        return;
    }
    let volumes = volumes();
    assert_eq!(volumes.len(), 20);
    let mut child = Command::new(&python)
        .args(["-c", FLYING_EDGES])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let mut input = child.stdin.take().expect("it is a pipe");
    for volume in &volumes {
        let counts = volume.counts.iter().flat_map(|&n| (n as i32).to_le_bytes());
        let numbers = [&[volume.isovalue][..], &volume.values].concat();
        let bytes: Vec<u8> = counts.chain(numbers.into_iter().flat_map(f32::to_le_bytes)).collect();
        input.write_all(&bytes).expect("Python reads");
    }
    drop(input);
    let output = child.wait_with_output().expect("Python ends");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("numbers");
    let mut extractor = Extractor::new();
    let mut triangles = 0;
    for (volume, line) in volumes.iter().zip(text.lines()) {
        let Volume { counts, isovalue, ref values } = *volume;
        let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let cells = VolumeCells { counts, values, origin: [0.0; 3], steps };
        let method = Method::Cubes(Cubes::default());
        let level = isovalue.next_down();
        let mesh = cells.extract(&method, &mut extractor, level, &Execution::default()).unwrap().mesh;
        let counted = format!("{} {}", mesh.positions.len(), mesh.triangles.len());
        assert_eq!(counted, line, "{counts:?} at {isovalue}");
        triangles += mesh.triangles.len();
    }
    assert_eq!(text.lines().count(), 20);
    assert!(triangles > 100_000, "{triangles}");
}
