//! The surface in a whole volume of samples.

use std::ffi::c_char;

use isostudy_extract::{Execution, Extractor, TriangleMesh, VolumeCells};

use crate::mesh::IsostudyMesh;
use crate::pointers::{method, numbers, object, value};
use crate::status::{Failure, IsostudyStatus, status_of};

/// Extracts whole volumes, and keeps the last mesh.
pub struct IsostudyVolume {
    extractor: Extractor,
    mesh: TriangleMesh,
}

/// Makes an object for whole volumes. It is written to `volume`, and freed by `isostudy_volume_free`.
///
/// # Safety
/// `volume` is null, which is an error, or leads to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_volume_new(volume: *mut *mut IsostudyVolume) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let volume = unsafe { object(volume, "volume")? };
        let made = IsostudyVolume { extractor: Extractor::new(), mesh: TriangleMesh::default() };
        *volume = Box::into_raw(Box::new(made));
        Ok(())
    })
}

/// Frees the object with its mesh. Null is nothing.
///
/// # Safety
/// `volume` is null or came from `isostudy_volume_new`, and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_volume_free(volume: *mut IsostudyVolume) {
    if !volume.is_null() {
        // SAFETY: it came from `Box::into_raw`, and nobody has it any more.
        drop(unsafe { Box::from_raw(volume) });
    }
}

/// Samples on a regular grid.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct IsostudySamples {
    /// As many as the product of the counts, x fastest.
    pub values: *const f32,
    /// How many there are along each axis, two at least.
    pub counts: [usize; 3],
    /// Where the first one lies.
    pub origin: [f64; 3],
    /// How far the next one is along each axis.
    pub spacing: [f64; 3],
}

/// Extracts the surface in a volume of samples by a method such as `"mc33"`. `threads` is 0 for all cores.
///
/// # Safety
/// `volume` came from `isostudy_volume_new`, and no other thread uses it. `samples` leads to a description whose `values` are as many as the product
/// of its counts. `method_name` leads to text that ends with a zero, and `mesh` to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_volume_extract(
    volume: *mut IsostudyVolume,
    method_name: *const c_char,
    samples: *const IsostudySamples,
    isovalue: f32,
    threads: usize,
    mesh: *mut IsostudyMesh,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (volume, method, samples, mesh) = unsafe {
            (
                object(volume, "volume")?,
                method(method_name)?,
                value(samples, "samples")?,
                object(mesh, "mesh")?,
            )
        };
        let IsostudySamples { values, counts, origin, spacing: [x, y, z] } = *samples;
        let count = counts.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
        let count =
            count.ok_or_else(|| Failure::argument(format!("counts {counts:?} are too many samples")))?;
        // SAFETY: the caller's promise.
        let values = unsafe { numbers(values, count, "samples.values")? };
        let steps = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        let cells = VolumeCells { counts, values, origin, steps };
        let execution = Execution { threads };
        volume.mesh = cells.extract_interpolated(&method, &mut volume.extractor, isovalue, &execution)?.mesh;
        *mesh = IsostudyMesh::of_mesh(&volume.mesh);
        Ok(())
    })
}
