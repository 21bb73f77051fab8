//! A scene that is handed over piece by piece.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::exception;
use penumbra::desc::SceneDesc;
use penumbra::error::{Result, Stop, Warnings};
use penumbra::import::blender::{
    BlenderScene, Ends, ImageSource, LayerArray, MeshArrays, MovedPoints, pointiness, random_per_island,
};

/// A scene in Blender's terms: one document and the arrays of its meshes. The add-on fills it; pieces
/// that are set again replace the old ones.
#[pyclass(frozen)]
#[derive(Default)]
pub struct Scene {
    inner: Mutex<BlenderScene>,
}

/// A flat array of floats, and its numbers.
type Floats<'py> = PyReadonlyArrayDyn<'py, f32>;
/// A flat array of integers.
type Ints<'py> = PyReadonlyArrayDyn<'py, i32>;
/// A layer of a mesh.
type Layer<'py> = (String, Floats<'py>);

impl Scene {
    /// The scene behind the lock; a panic while it was held leaves old values, never half of one.
    pub(super) fn lock(&self) -> MutexGuard<'_, BlenderScene> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The scene as authored, and what was told of it, unless `stop` ends that.
    pub(super) fn read(&self, stop: &Stop) -> Result<(SceneDesc, Warnings)> {
        let mut warnings = Warnings::new();
        let desc = self.lock().scene_unless(stop, &mut warnings)?;
        Ok((desc, warnings))
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Takes in everything but materials, meshes, images in memory and placements: JSON.
    fn set_document(&self, json: &str) -> PyResult<()> {
        self.lock().set_document(json).map_err(|error| exception(&error))
    }

    /// Takes in what was edited of the document: JSON of its lights, its world or its images.
    fn edit_document(&self, json: &str) -> PyResult<()> {
        self.lock().edit_document(json).map_err(|error| exception(&error))
    }

    /// Takes in the material `key`: JSON.
    fn set_material(&self, key: u64, json: &str) -> PyResult<()> {
        self.lock().set_material(key, json).map_err(|error| exception(&error))
    }

    /// Says which materials objects mean by their indices, by key; all others are forgotten.
    fn set_materials(&self, keys: Vec<u64>) -> PyResult<()> {
        self.lock().set_materials(&keys).map_err(|error| exception(&error))
    }

    /// Takes in the mesh `key`. Arrays are C-contiguous, float32 and int32: positions (n, 3),
    /// corner_verts (c), triangles (t, 3) of corners, normals (c, 3) or (n, 3), material_index per
    /// polygon with triangle_polygons (t), uvs [(name, (c, 2))], colors and attributes [(name, (c or n, 4))],
    /// texture_space (middle, half of the size).
    #[pyo3(signature = (key, name, *, positions, corner_verts, triangles, normals=None, material_index=None,
        triangle_polygons=None, uvs=Vec::new(), colors=Vec::new(), attributes=Vec::new(),
        texture_space=None))]
    fn set_mesh(
        &self,
        py: Python<'_>,
        key: u64,
        name: &str,
        positions: Floats<'_>,
        corner_verts: Ints<'_>,
        triangles: Ints<'_>,
        normals: Option<Floats<'_>>,
        material_index: Option<Ints<'_>>,
        triangle_polygons: Option<Ints<'_>>,
        uvs: Vec<Layer<'_>>,
        colors: Vec<Layer<'_>>,
        attributes: Vec<Layer<'_>>,
        texture_space: Option<[[f64; 3]; 2]>,
    ) -> PyResult<()> {
        let arrays = MeshArrays {
            positions: floats(&positions)?,
            corner_verts: ints(&corner_verts)?,
            triangles: ints(&triangles)?,
            normals: normals.as_ref().map_or(Ok(&[][..]), floats)?,
            material_index: material_index.as_ref().map_or(Ok(&[][..]), ints)?,
            triangle_polygons: triangle_polygons.as_ref().map_or(Ok(&[][..]), ints)?,
            texture_space,
        };
        let (uvs, colors, attributes) = (layers(&uvs)?, layers(&colors)?, layers(&attributes)?);
        py.detach(|| self.lock().set_mesh(key, name, &arrays, &uvs, [&colors, &attributes]))
            .map_err(|error| exception(&error))
    }

    /// Takes in strands as shape `key`: positions (n, 3), radii (n), and where each strand ends (uint32, the
    /// index behind its last point); points that stand alone where `ends` is empty. Between its points a strand is
    /// straight, or a Catmull-Rom spline where `smooth`; uvs [(name, (strands, 2))]; `moving` where its motion will follow;
    /// attributes [(name, (n or strands, 4))].
    #[pyo3(signature = (key, name, positions, radii, ends, smooth=false, uvs=Vec::new(), moving=false,
        attributes=Vec::new()))]
    fn set_rounds(
        &self,
        key: u64,
        name: &str,
        positions: Floats<'_>,
        radii: Floats<'_>,
        ends: PyReadonlyArray1<'_, u32>,
        smooth: bool,
        uvs: Vec<Layer<'_>>,
        moving: bool,
        attributes: Vec<Layer<'_>>,
    ) -> PyResult<()> {
        let ends = ends.as_slice().map_err(|_| contiguous())?;
        let (positions, radii) = (floats(&positions)?, floats(&radii)?);
        let ends = Ends { points: ends, smooth, moving };
        let (uvs, attributes) = (layers(&uvs)?, layers(&attributes)?);
        self.lock()
            .set_rounds(key, name, positions, radii, ends, [&uvs, &attributes])
            .map_err(|error| exception(&error))
    }

    /// Takes in where the points of the shape `key` are at other times of the shutter: [(frames after the frame,
    /// positions (n, 3))].
    fn set_shape_motion(&self, py: Python<'_>, key: u64, moved: Vec<(f64, Floats<'_>)>) -> PyResult<()> {
        let moved = moved.iter().map(|(time, positions)| Ok((*time, floats(positions)?)));
        let moved = moved.map(|at| at.map(|(time, positions)| MovedPoints { time, positions }));
        let moved = moved.collect::<PyResult<Vec<_>>>()?;
        py.detach(|| self.lock().set_shape_motion(key, &moved));
        Ok(())
    }

    /// Takes in where instances (uint32, indices of those of `set_instances`) are so many frames after the frame:
    /// matrices (float32, 16 per instance, by rows).
    fn add_instance_motion(
        &self,
        time: f64,
        instances: PyReadonlyArray1<'_, u32>,
        matrices: Floats<'_>,
    ) -> PyResult<()> {
        let instances = instances.as_slice().map_err(|_| contiguous())?;
        self.lock().add_instance_motion(time, instances, floats(&matrices)?).map_err(|error| exception(&error))
    }

    /// The numbers of Random Per Island for each of `points` points of a mesh: float32. `edges` (int32, (e, 2)) are pairs
    /// of points.
    #[staticmethod]
    fn random_per_island<'py>(py: Python<'py>, points: usize, edges: Ints<'_>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let edges = ints(&edges)?;
        Ok(PyArray1::from_vec(py, py.detach(|| random_per_island(points, edges))))
    }

    /// The numbers of Pointiness for each point of a mesh: float32. `positions` and `normals` are (n, 3), float32; `edges`
    /// (int32, (e, 2)) are pairs of points.
    #[staticmethod]
    fn pointiness<'py>(
        py: Python<'py>,
        positions: Floats<'_>,
        normals: Floats<'_>,
        edges: Ints<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let (positions, normals, edges) = (floats(&positions)?, floats(&normals)?, ints(&edges)?);
        Ok(PyArray1::from_vec(py, py.detach(|| pointiness(positions, normals, edges))))
    }

    /// Forgets the shape `key`.
    fn remove_shape(&self, key: u64) {
        self.lock().remove_shape(key);
    }

    /// Takes in the bytes of a packed image file, or of one tile's.
    #[pyo3(signature = (name, bytes, tile=None))]
    fn set_image_bytes(&self, name: &str, bytes: &[u8], tile: Option<u32>) {
        self.lock().set_image(name, tile, ImageSource::Encoded(bytes.to_vec()));
    }

    /// Takes in pixels: float32, four per pixel, rows from the bottom; `linear` for linear values.
    fn set_image_pixels(&self, name: &str, width: u32, height: u32, pixels: Floats<'_>, linear: bool) -> PyResult<()> {
        let values = floats(&pixels)?.to_vec();
        self.lock().set_image(name, None, ImageSource::Pixels { width, height, values, linear });
        Ok(())
    }

    /// Takes in all placements: object indices (uint32), matrices (float32, 16 per instance, by rows) and
    /// random ids (uint32; 0 for what is no instance).
    fn set_instances(
        &self,
        objects: PyReadonlyArray1<'_, u32>,
        matrices: Floats<'_>,
        random_ids: PyReadonlyArray1<'_, u32>,
    ) -> PyResult<()> {
        let objects = objects.as_slice().map_err(|_| contiguous())?;
        let random_ids = random_ids.as_slice().map_err(|_| contiguous())?;
        self.lock().set_instances(objects, floats(&matrices)?, random_ids).map_err(|error| exception(&error))
    }
}

fn contiguous() -> PyErr {
    PyValueError::new_err("arrays must be C-contiguous")
}

fn floats<'a>(array: &'a Floats<'_>) -> PyResult<&'a [f32]> {
    array.as_slice().map_err(|_| contiguous())
}

fn ints<'a>(array: &'a Ints<'_>) -> PyResult<&'a [i32]> {
    array.as_slice().map_err(|_| contiguous())
}

fn layers<'a>(layers: &'a [Layer<'_>]) -> PyResult<Vec<LayerArray<'a>>> {
    layers.iter().map(|(name, values)| Ok(LayerArray { name, values: floats(values)? })).collect()
}
