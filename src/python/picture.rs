//! What a render gave.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::exception;
use penumbra::film;
use penumbra::output::{Metadata, exr, png};
use penumbra::plan::Plan;

/// A picture: named layers of float32, rows from the top.
#[pyclass(frozen)]
pub struct Picture {
    pub(super) picture: film::Picture,
    pub(super) metadata: Metadata,
    pub(super) half: bool,
    /// What was simulated and why, where that was asked for.
    pub(super) plan: Plan,
    /// True where the observer stopped the render.
    #[pyo3(get)]
    pub(super) interrupted: bool,
}

impl Picture {
    fn layer(&self, name: &str) -> PyResult<&film::Layer> {
        self.picture.layer(name).ok_or_else(|| {
            let names: Vec<&str> = self.picture.layers.iter().map(|layer| layer.name.as_str()).collect();
            PyKeyError::new_err(format!("no layer \"{name}\"; there are {}", names.join(", ")))
        })
    }
}

#[pymethods]
impl Picture {
    /// Pixels per row.
    #[getter]
    fn width(&self) -> u32 {
        self.picture.width
    }

    /// Rows.
    #[getter]
    fn height(&self) -> u32 {
        self.picture.height
    }

    /// Names of the layers, as in a file ("Diffuse Direct").
    #[getter]
    fn layers(&self) -> Vec<&str> {
        self.picture.layers.iter().map(|layer| layer.name.as_str()).collect()
    }

    /// Which effects were simulated, where `plan=True` asked for that: dicts of subject, effect, on, because, adds.
    #[getter]
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let row = |row: &penumbra::plan::Row| {
            let dict = PyDict::new(py);
            dict.set_item("subject", row.subject)?;
            dict.set_item("effect", row.effect)?;
            dict.set_item("on", row.on)?;
            dict.set_item("because", &row.because)?;
            dict.set_item("adds", &row.adds)?;
            Ok(dict)
        };
        self.plan.rows.iter().map(row).collect()
    }

    /// Samples per pixel, the mean.
    #[getter]
    fn spp(&self) -> f64 {
        self.metadata.samples
    }

    /// Seconds from the first ray to the last.
    #[getter]
    fn seconds(&self) -> f64 {
        self.metadata.seconds
    }

    /// The picture's noise in units of the display's range: the estimate and both ends of its 95 % interval; None
    /// where it was not asked for, or is not estimable yet.
    #[getter]
    fn error(&self) -> Option<(f64, f64, f64)> {
        self.metadata.accuracy?.display.ok().map(|figure| (figure.value, figure.low, figure.high))
    }

    /// Name of the camera.
    #[getter]
    fn camera(&self) -> &str {
        &self.metadata.camera
    }

    /// What was replaced or left out, a sentence each.
    #[getter]
    fn warnings(&self) -> Vec<&str> {
        self.metadata.warnings.iter().map(String::as_str).collect()
    }

    /// The channels of a layer ("RGBA").
    fn channels(&self, name: &str) -> PyResult<String> {
        Ok(self.layer(name)?.channels.concat())
    }

    /// A copy of a layer: float32 of (height, width, channels).
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let layer = self.layer(name)?;
        let shape = [self.picture.height as usize, self.picture.width as usize, layer.channels.len()];
        PyArray1::from_slice(py, &layer.data).reshape(shape)
    }

    fn __contains__(&self, name: &str) -> bool {
        self.picture.layer(name).is_some()
    }

    fn __len__(&self) -> usize {
        self.picture.layers.len()
    }

    /// A layer as Blender's render result takes it: flat, rows from the bottom.
    fn flat<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let layer = self.layer(name)?;
        let row = self.picture.width as usize * layer.channels.len();
        let turned: Vec<f32> = layer.data.chunks_exact(row.max(1)).rev().flatten().copied().collect();
        Ok(PyArray1::from_vec(py, turned))
    }

    /// What a file of the picture says of its Cryptomattes: [(name of the attribute, text)].
    #[pyo3(signature = (view_layer="ViewLayer"))]
    fn cryptomatte(&self, view_layer: &str) -> Vec<(String, String)> {
        self.metadata.manifests.iter().flat_map(|manifest| exr::cryptomatte(manifest, view_layer)).collect()
    }

    /// Writes all layers as a multi-layer OpenEXR file.
    #[pyo3(signature = (path, *, view_layer="ViewLayer".to_owned()))]
    fn save(&self, py: Python<'_>, path: PathBuf, view_layer: String) -> PyResult<()> {
        let options = exr::Options { half: self.half, view_layer, ..exr::Options::default() };
        py.detach(|| exr::write(&path, &self.picture, &self.metadata, &options)).map_err(|error| exception(&error))
    }

    /// Writes a layer as an sRGB PNG.
    #[pyo3(signature = (path, layer="Combined"))]
    fn save_png(&self, py: Python<'_>, path: PathBuf, layer: &str) -> PyResult<()> {
        py.detach(|| png::write(&path, &self.picture, layer)).map_err(|error| exception(&error))
    }

    fn __repr__(&self) -> String {
        let (width, height) = (self.picture.width, self.picture.height);
        format!("<penumbra.Picture {width}x{height}, {:.1} spp, {} layers>", self.metadata.samples, self.__len__())
    }
}
