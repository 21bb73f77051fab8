//! The choice of an instruction set, made once per process.

use std::sync::OnceLock;

/// An instruction set that traversal is compiled for. All give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// Plain Rust, on every machine; the reference for the others.
    Scalar,
    /// x86-64 without extensions.
    Sse2,
    /// AVX2, BMI1 and BMI2.
    Avx2,
    /// AVX-512 F and VL, on vectors of 256 bits.
    Avx512,
    /// AArch64.
    Neon,
}

impl Isa {
    /// All that this machine can run, the slowest first.
    pub fn available() -> &'static [Self] {
        static AVAILABLE: OnceLock<Vec<Isa>> = OnceLock::new();
        AVAILABLE.get_or_init(|| {
            let mut list = vec![Self::Scalar];
            #[cfg(all(target_arch = "x86_64", not(miri)))]
            {
                list.push(Self::Sse2);
                let avx2 = is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2");
                if avx2 {
                    list.push(Self::Avx2);
                }
                if avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                    list.push(Self::Avx512);
                }
            }
            #[cfg(all(target_arch = "aarch64", not(miri)))]
            list.push(Self::Neon);
            list
        })
    }

    /// The fastest that this machine can run.
    pub fn best() -> Self {
        *Self::available().last().expect("the scalar one is always there")
    }

    /// Its name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scalar_twin_is_always_there() {
        assert_eq!(Isa::available()[0], Isa::Scalar);
        assert!(Isa::available().contains(&Isa::best()));
    }
}
