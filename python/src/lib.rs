//! What `isostudy/__init__.py` calls. That file has the documentation for users.
//!
//! Samples are read where NumPy has them, and meshes are read where Rust has them: neither is copied. Whatever takes long lets other
//! threads of Python run.

mod answers;
mod mesh;
mod samples;

use isostudy_extract::{Execution, Extractor, Method, MethodError, VolumeCells, VolumeCellsError, presets};
use isostudy_mesh::quality::quality as quality_of;
use isostudy_mesh::topology::topology as topology_of;
use isostudy_trilinear::{Samples, Ties, verify as verify_mesh};
use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::mesh::{Mesh, distribution};
use crate::samples::{Volume, steps};

/// Native part of `isostudy`.
#[pymodule]
fn _isostudy(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Mesh>()?;
    module.add_class::<mesh::Buffer>()?;
    module.add_function(wrap_pyfunction!(answers::analyse, module)?)?;
    module.add_function(wrap_pyfunction!(extract, module)?)?;
    module.add_function(wrap_pyfunction!(methods, module)?)?;
    module.add_function(wrap_pyfunction!(quality, module)?)?;
    module.add_function(wrap_pyfunction!(topology, module)?)?;
    module.add_function(wrap_pyfunction!(verify, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}

/// The surface in an array of three axes.
#[pyfunction]
fn extract(
    py: Python<'_>,
    array: PyReadonlyArrayDyn<'_, f32>,
    isovalue: f32,
    method: &str,
    spacing: [f64; 3],
    origin: [f64; 3],
    threads: usize,
) -> PyResult<Mesh> {
    let method = method_of(method)?;
    let Volume { counts, values } = Volume::try_new(&array)?;
    let steps = steps(spacing);
    let extracted = py.detach(|| {
        let cells = VolumeCells { counts, values, origin, steps };
        let execution = Execution { threads };
        cells.extract_interpolated(&method, &mut Extractor::new(), isovalue, &execution)
    });
    Ok(Mesh::new(extracted.map_err(raised)?.mesh))
}

/// Want of memory is Python's `MemoryError`, all else a `ValueError`.
fn raised(error: VolumeCellsError) -> PyErr {
    use isostudy_extract::ExtractError::{NoMemoryForMesh, OutOfMemory};
    match &error {
        VolumeCellsError::Extract(MethodError::Extract(NoMemoryForMesh | OutOfMemory { .. })) => {
            PyMemoryError::new_err(error.to_string())
        }
        _ => PyValueError::new_err(error.to_string()),
    }
}

fn method_of(id: &str) -> PyResult<Method> {
    let found = presets().iter().find(|preset| preset.id == id).map(|preset| preset.method);
    found.ok_or_else(|| {
        let all: Vec<&str> = presets().iter().map(|preset| preset.id).collect();
        PyValueError::new_err(format!("there is no method {id:?}; there are {}", all.join(", ")))
    })
}

/// Of each method its name, its words, its source, and whether every mesh of it is a manifold.
#[pyfunction]
fn methods() -> Vec<(&'static str, &'static str, &'static str, bool)> {
    presets().iter().map(|of| (of.id, of.label, of.source, of.method.promises().manifold)).collect()
}

/// What the triangles of a mesh are worth.
#[pyfunction]
fn quality<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<Bound<'py, PyDict>> {
    let report = py.detach(|| quality_of(mesh.get()));
    let found = PyDict::new(py);
    found.set_item("triangles", report.triangles)?;
    found.set_item("degenerate", report.degenerate)?;
    found.set_item("shortest_edge", report.shortest_edge)?;
    for (name, values) in [
        ("radius_ratio", &report.radius_ratio),
        ("edge_ratio", &report.edge_ratio),
        ("min_angle_deg", &report.min_angle_deg),
        ("max_angle_deg", &report.max_angle_deg),
        ("area", &report.area),
    ] {
        found.set_item(name, distribution(py, values)?)?;
    }
    Ok(found)
}

/// How the triangles of a mesh hang together.
#[pyfunction]
fn topology<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<Bound<'py, PyDict>> {
    let report = py.detach(|| topology_of(mesh.get()));
    let found = PyDict::new(py);
    for (name, count) in [
        ("vertices", report.vertices),
        ("unused_vertices", report.unused_vertices),
        ("edges", report.edges),
        ("triangles", report.triangles),
        ("boundary_edges", report.boundary_edges),
        ("non_manifold_edges", report.non_manifold_edges),
        ("non_manifold_vertices", report.non_manifold_vertices),
        ("misoriented_edges", report.misoriented_edges),
        ("components", report.components),
        ("boundary_loops", report.boundary_loops),
    ] {
        found.set_item(name, count)?;
    }
    found.set_item("euler_characteristic", report.euler_characteristic)?;
    found.set_item("is_closed_manifold", report.is_closed_manifold())?;
    Ok(found)
}

/// Holds a mesh against the exact topology of the samples' trilinear interpolant.
#[pyfunction]
fn verify<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    array: PyReadonlyArrayDyn<'_, f32>,
    isovalue: f32,
) -> PyResult<Bound<'py, PyDict>> {
    let Volume { counts, values } = Volume::try_new(&array)?;
    let verdict = py.detach(|| -> Result<_, isostudy_trilinear::SamplesError> {
        verify_mesh(mesh.get(), &Samples::try_new(counts, values)?, isovalue, Ties::Outside)
    });
    let verdict = verdict.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let answer = PyDict::new(py);
    answer.set_item("is_right", verdict.is_right())?;
    for (name, summary) in [("found", &verdict.found), ("expected", &verdict.expected)] {
        let counts = PyDict::new(py);
        counts.set_item("components", summary.components)?;
        counts.set_item("euler_characteristic", summary.euler_characteristic)?;
        counts.set_item("boundary_loops", summary.boundary_loops)?;
        counts.set_item("genus", summary.genus)?;
        answer.set_item(name, counts)?;
    }
    answer.set_item("tunnel_cells", verdict.tunnel_cells)?;
    let findings =
        verdict.findings.iter().map(|finding| (finding.fault.to_string(), finding.found, finding.expected));
    answer.set_item("findings", findings.collect::<Vec<_>>())?;
    Ok(answer)
}
