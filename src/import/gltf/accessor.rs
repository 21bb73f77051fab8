//! Accessors (glTF 2.0, section 3.6.2): typed, strided, normalized and sparse views of buffers.
//!
//! Every offset is checked with overflow in mind, and memory is only taken for what the file holds.

use super::buffer::Buffers;
use super::json::{Accessor, Root};

/// Elements of an accessor without data that are always allowed, zeros all of them.
const FREE_ZEROS: usize = 1 << 12;

/// Type of one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u32) -> Result<Self, String> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(format!("has component type {code}, which glTF 2.0 doesn't know")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value at the start of `b`; integers of normalized accessors become −1 to 1 or 0 to 1.
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        let scale = |v: f32, max: f32| if normalized { (v / max).max(-1.0) } else { v };
        match self {
            Self::I8 => scale(f32::from(b[0] as i8), 127.0),
            Self::U8 => scale(f32::from(b[0]), 255.0),
            Self::I16 => scale(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => scale(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => scale(u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    /// The unsigned value at the start of `b`.
    fn integer(self, b: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => u32::from(b[0]),
            Self::I16 | Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }
}

/// Bytes of one element: where each component stands, and the size of the whole.
#[derive(Clone, Copy)]
struct Shape {
    component: Component,
    columns: usize,
    rows: usize,
}

impl Shape {
    fn of(accessor: &Accessor) -> Result<Self, String> {
        let component = Component::from_code(accessor.component_type)?;
        let (columns, rows) = match accessor.kind.as_str() {
            "SCALAR" => (1, 1),
            "VEC2" => (1, 2),
            "VEC3" => (1, 3),
            "VEC4" => (1, 4),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            kind => return Err(format!("has type '{kind}', which glTF 2.0 doesn't know")),
        };
        Ok(Self { component, columns, rows })
    }

    fn components(self) -> usize {
        self.columns * self.rows
    }

    /// Bytes from one column to the next; columns of matrices start at multiples of four.
    fn column_stride(self) -> usize {
        let size = self.rows * self.component.size();
        if self.columns > 1 { size.next_multiple_of(4) } else { size }
    }

    fn size(self) -> usize {
        self.columns * self.column_stride()
    }

    fn offset(self, component: usize) -> usize {
        component / self.rows * self.column_stride() + component % self.rows * self.component.size()
    }
}

/// Elements of one shape at a stride, all inside of `bytes`.
struct Span<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Span<'a> {
    /// `count` elements of `size` bytes in a buffer view.
    fn new(
        root: &Root,
        buffers: &'a Buffers<'_>,
        view: usize,
        offset: usize,
        size: usize,
        count: usize,
    ) -> Result<Self, String> {
        let (bytes, view_json) = buffers.view(root, view)?;
        let stride = view_json.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(format!("has elements of {size} bytes, buffer view {view} a stride of {stride}"));
        }
        let length = count.saturating_sub(1).checked_mul(stride).and_then(|l| l.checked_add(size));
        let end = if count == 0 { Some(offset) } else { length.and_then(|l| l.checked_add(offset)) };
        match end.and_then(|end| bytes.get(offset..end)) {
            Some(bytes) => Ok(Self { bytes, stride }),
            None => Err(format!(
                "has {count} elements of {size} bytes from byte {offset}; buffer view {view} has {} bytes",
                bytes.len()
            )),
        }
    }

    fn element(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

/// Reads accessors of one file. Errors are sentences that name the accessor.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    /// The JSON.
    pub root: &'a Root,
    /// The bytes.
    pub buffers: &'a Buffers<'a>,
}

impl<'a> Reader<'a> {
    /// How many components an element has.
    pub fn components(&self, index: usize) -> Result<usize, String> {
        Ok(Shape::of(self.accessor(index)?).map_err(|e| format!("accessor {index} {e}"))?.components())
    }

    /// Elements of `N` numbers each.
    pub fn floats<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, String> {
        let normalized = self.accessor(index)?.normalized;
        self.gather(index, |component, bytes| component.float(bytes, normalized))
    }

    /// Elements of `N` unsigned integers each.
    pub fn integers<const N: usize>(&self, index: usize) -> Result<Vec<[u32; N]>, String> {
        let component = Component::from_code(self.accessor(index)?.component_type);
        match component.map_err(|e| format!("accessor {index} {e}"))? {
            Component::U8 | Component::U16 | Component::U32 => self.gather(index, Component::integer),
            other => Err(format!("accessor {index} holds {other:?}, unsigned integers are needed")),
        }
    }

    /// Every component of every element in one list, and how many an element has.
    pub fn flat(&self, index: usize) -> Result<(Vec<f32>, usize), String> {
        fn flatten<const N: usize>(values: Vec<[f32; N]>) -> (Vec<f32>, usize) {
            (values.into_flattened(), N)
        }
        match self.components(index)? {
            1 => self.floats::<1>(index).map(flatten),
            2 => self.floats::<2>(index).map(flatten),
            3 => self.floats::<3>(index).map(flatten),
            4 => self.floats::<4>(index).map(flatten),
            9 => self.floats::<9>(index).map(flatten),
            _ => self.floats::<16>(index).map(flatten),
        }
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, String> {
        let count = self.root.accessors.len();
        self.root.accessors.get(index).ok_or_else(|| format!("names accessor {index} of {count}"))
    }

    fn gather<T: Copy + Default, const N: usize>(
        &self,
        index: usize,
        decode: impl Fn(Component, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, String> {
        let accessor = self.accessor(index)?;
        self.gather_elements(accessor, decode).map_err(|e| format!("accessor {index} {e}"))
    }

    fn gather_elements<T: Copy + Default, const N: usize>(
        &self,
        accessor: &Accessor,
        decode: impl Fn(Component, &[u8]) -> T,
    ) -> Result<Vec<[T; N]>, String> {
        let shape = Shape::of(accessor)?;
        if shape.components() != N {
            return Err(format!("is a {}, {N} components are needed", accessor.kind));
        }
        let offsets: [usize; N] = std::array::from_fn(|c| shape.offset(c));
        let element = |bytes: &[u8]| offsets.map(|offset| decode(shape.component, &bytes[offset..]));
        let count = accessor.count;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let span = Span::new(self.root, self.buffers, view, accessor.byte_offset, shape.size(), count)?;
                // A stride of 0 can't come here: it would be less than the size of an element.
                (0..count).map(|i| element(span.element(i))).collect()
            }
            None if count <= FREE_ZEROS.max(self.buffers.total_bytes) => vec![[T::default(); N]; count],
            None => return Err(format!("has {count} elements and no data, in a file of far fewer bytes")),
        };
        if let Some(sparse) = &accessor.sparse {
            let index_component = Component::from_code(sparse.indices.component_type)?;
            let (Some(index_view), Some(value_view)) = (sparse.indices.buffer_view, sparse.values.buffer_view) else {
                return Err("is sparse and names no buffer view for it".into());
            };
            let (size, n) = (index_component.size(), sparse.count);
            let indices = Span::new(self.root, self.buffers, index_view, sparse.indices.byte_offset, size, n)?;
            let size = shape.size();
            let replacements = Span::new(self.root, self.buffers, value_view, sparse.values.byte_offset, size, n)?;
            for i in 0..n {
                let at = index_component.integer(indices.element(i)) as usize;
                let slot =
                    values.get_mut(at).ok_or_else(|| format!("has a sparse value for element {at} of {count}"))?;
                *slot = element(replacements.element(i));
            }
        }
        Ok(values)
    }
}
