//! A mesh that NumPy reads where it is.

use std::sync::Arc;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::distribution::Distribution;
use isostudy_mesh::glam::Vec3;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A triangle mesh.
#[pyclass(frozen, module = "isostudy._isostudy")]
pub(crate) struct Mesh(Arc<TriangleMesh>);

/// One of a mesh's arrays, as `numpy.asarray` takes it. It keeps the mesh.
#[pyclass(frozen, module = "isostudy._isostudy")]
pub(crate) struct Buffer {
    mesh: Arc<TriangleMesh>,
    which: Which,
}

#[derive(Clone, Copy)]
enum Which {
    Vertices,
    Normals,
    Faces,
}

impl Mesh {
    pub(crate) fn new(mesh: TriangleMesh) -> Self {
        Self(Arc::new(mesh))
    }

    pub(crate) fn get(&self) -> &TriangleMesh {
        &self.0
    }

    fn buffer(&self, which: Which) -> Buffer {
        Buffer { mesh: Arc::clone(&self.0), which }
    }
}

#[pymethods]
impl Mesh {
    /// A mesh of arrays with three numbers a row.
    #[new]
    fn of_arrays(
        vertices: PyReadonlyArrayDyn<'_, f32>,
        faces: PyReadonlyArrayDyn<'_, u32>,
    ) -> PyResult<Self> {
        let rows = |name: &str, shape: &[usize]| match shape {
            &[_, 3] => Ok(()),
            _ => Err(PyValueError::new_err(format!("{name} of shape {shape:?}: there must be three a row"))),
        };
        rows("vertices", vertices.shape())?;
        rows("faces", faces.shape())?;
        let not_contiguous =
            |name: &str| PyValueError::new_err(format!("{name} are not contiguous in memory"));
        let positions = vertices.as_slice().map_err(|_| not_contiguous("vertices"))?;
        let indices = faces.as_slice().map_err(|_| not_contiguous("faces"))?;
        let positions: Vec<Vec3> = positions.chunks_exact(3).map(Vec3::from_slice).collect();
        let count = positions.len();
        if let Some((row, vertex)) = indices.iter().enumerate().find(|(_, v)| **v as usize >= count) {
            let face = row / 3;
            return Err(PyValueError::new_err(format!(
                "face {face} has vertex {vertex}, and there are {count} vertices"
            )));
        }
        let triangles = indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect();
        Ok(Self::new(TriangleMesh { positions, triangles, ..TriangleMesh::default() }))
    }

    fn vertices(&self) -> Buffer {
        self.buffer(Which::Vertices)
    }

    fn normals(&self) -> Buffer {
        self.buffer(Which::Normals)
    }

    fn faces(&self) -> Buffer {
        self.buffer(Which::Faces)
    }

    /// The volume inside, in units of the vertices.
    fn volume(&self) -> f64 {
        self.0.volume()
    }
}

#[pymethods]
impl Buffer {
    /// NumPy's own protocol, version 3: where the numbers are. They are read only.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let TriangleMesh { positions, normals, triangles } = &*self.mesh;
        let (rows, address, kind) = match self.which {
            Which::Vertices => (positions.len(), positions.as_ptr().expose_provenance(), "f4"),
            Which::Normals => (normals.len(), normals.as_ptr().expose_provenance(), "f4"),
            Which::Faces => (triangles.len(), triangles.as_ptr().expose_provenance(), "u4"),
        };
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (rows, 3))?;
        interface.set_item("typestr", format!("{order}{kind}"))?;
        interface.set_item("data", (address, true))?;
        Ok(interface)
    }
}

/// The numbers that describe a distribution.
pub(crate) fn distribution<'py>(py: Python<'py>, of: &Distribution) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for (name, value) in
        [("mean", of.mean), ("sd", of.sd), ("min", of.min), ("median", of.median), ("max", of.max)]
    {
        found.set_item(name, value)?;
    }
    found.set_item("count", of.count)?;
    Ok(found)
}
