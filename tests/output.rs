//! Pictures written and read again: names, values, header, failures.

use std::fs;
use std::io::BufReader;
use std::path::Path;
use std::time::{Duration, UNIX_EPOCH};

use exr::meta::attribute::AttributeValue;
use penumbra::error::Error;
use penumbra::film::cryptomatte::{CryptoKind, Manifest, id_from_name};
use penumbra::film::{
    Accuracy, CryptoSample, Doubt, Figure, Film, FirstHit, Layer, PASSES, PassSet, Picture, PixelSample, SampleId,
    Split, Storage,
};
use penumbra::math::{Rgb, Vec3};
use penumbra::output::exr::{Compression, Options};
use penumbra::output::{Metadata, exr as file, png};

/// A picture of every pass: a gradient, no two pixels alike, "Cube" on the left, "Kugel ö" on the right.
fn sample_picture(width: u32, height: u32, passes: &str) -> Picture {
    let mut film = Film::new(width, height, PassSet::parse(passes).expect("known passes"));
    for tile in film.tiles_mut() {
        for (x, y) in tile.pixels() {
            let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
            let color = Rgb::new(u, v, 0.25 + 0.5 * u * v);
            let split =
                |s: f32| Split { diffuse: color * s, glossy: color * (0.3 * s), transmission: color * (0.1 * s) };
            let name = if 2 * x < width { "Cube" } else { "Kugel ö" };
            let sample = PixelSample {
                combined: color * 3.0,
                alpha: 1.0 - 0.5 * u,
                direct: split(0.7),
                indirect: split(0.2),
                color: split(0.8),
                unshadowed: color,
                ao: color,
                emission: color * 1e-3,
                environment: color * 2e5,
                normal: Vec3::new(u, v, -1.0),
                uv: [u, v, 1.0],
                denoising_normal: Vec3::new(-u, v, 0.5),
                denoising_albedo: color,
                denoising_depth: 10.0 * u,
                crypto: CryptoSample {
                    object: id_from_name(name),
                    material: id_from_name("Material"),
                    asset: id_from_name(name),
                    coverage: 1.0,
                },
                ..PixelSample::default()
            };
            assert!(tile.add(SampleId { x, y, index: 0 }, 1.0, &sample));
            let position = Vec3::new(u, v, 1.0 / 3.0);
            tile.set_first_hit(x, y, FirstHit { depth: 5.0 + u, position, object_index: 3.0, material_index: 4.0 });
        }
    }
    film.develop()
}

fn metadata() -> Metadata {
    let manifest = |kind, names: &[&str]| Manifest { kind, names: names.iter().map(|&name| name.to_owned()).collect() };
    Metadata {
        scene: "shots/Straße.glb".to_owned(),
        camera: "Camera".to_owned(),
        frame: Some(12.5),
        samples: 64.0,
        seed: 7,
        seconds: 3.25,
        accuracy: Some(Accuracy {
            rmse: Ok(Figure { value: 0.5, low: 0.25, high: 1.0 }),
            rel_mse: Err(Doubt::HeavyTail),
            display: Ok(Figure { value: 0.02, low: 0.01, high: 0.04 }),
        }),
        date: Some(UNIX_EPOCH + Duration::from_secs(951_782_400)),
        non_finite: 2,
        non_finite_first: Some(SampleId { x: 3, y: 4, index: 5 }),
        warnings: vec!["a.glb, node: one".to_owned(), "two".to_owned()],
        settings: vec![("max_bounces".to_owned(), "12".to_owned())],
        owner: Some("Studio".to_owned()),
        comments: None,
        manifests: vec![
            manifest(CryptoKind::Object, &["Cube", "Kugel ö"]),
            manifest(CryptoKind::Material, &["Material"]),
            manifest(CryptoKind::Asset, &["Cube", "Kugel ö"]),
        ],
        ..Metadata::default()
    }
}

fn in_folder<T>(test: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().expect("a temporary folder");
    test(folder.path())
}

fn header(path: &Path) -> exr::meta::header::Header {
    let file = BufReader::new(fs::File::open(path).expect("file"));
    exr::meta::MetaData::read_from_buffered(file, true).expect("a valid header").headers[0].clone()
}

fn attribute(header: &exr::meta::header::Header, name: &str) -> Option<String> {
    let (_, value) = header.own_attributes.other.iter().find(|(key, _)| key.as_slice() == name.as_bytes())?;
    let AttributeValue::Text(text) = value else { panic!("{name} is no text") };
    Some(String::from_utf8_lossy(text.as_slice()).into_owned())
}

#[test]
fn every_pass_comes_back_bit_for_bit() {
    in_folder(|folder| {
        // 37 × 21 crosses tiles and 16-row blocks; 1 × 1 is the smallest.
        for (width, height) in [(37, 21), (1, 1)] {
            let picture = sample_picture(width, height, "all");
            for compression in [Compression::None, Compression::Rle, Compression::Zip, Compression::Piz] {
                let path = folder.join(format!("{compression:?}.exr"));
                let options = Options { compression, ..Options::default() };
                file::write(&path, &picture, &metadata(), &options).expect("written");
                let read = file::read(&path).expect("read");
                assert_eq!((read.width, read.height, read.layers.len()), (width, height, picture.layers.len()));
                for (read, written) in read.layers.iter().zip(&picture.layers) {
                    assert_eq!(read.name, format!("ViewLayer.{}", written.name));
                    assert_eq!(read.channels, written.channels, "{}", read.name);
                    assert_eq!(read.storage, written.storage, "{}", read.name);
                    assert_eq!(read.data, written.data, "{} {compression:?}", read.name);
                }
            }
        }
    });
}

#[test]
fn half_is_for_color_only_and_never_infinite() {
    in_folder(|folder| {
        let picture = sample_picture(20, 10, "all");
        let path = folder.join("half.exr");
        file::write(&path, &picture, &metadata(), &Options { half: true, ..Options::default() }).expect("written");
        let read = file::read(&path).expect("read");
        for (read, written) in read.layers.iter().zip(&picture.layers) {
            for (a, b) in read.data.iter().zip(&written.data) {
                match written.storage {
                    Storage::Data => assert_eq!(a, b, "{}", read.name),
                    // Half an ulp of 11 bits, down to half's smallest step.
                    Storage::Color => {
                        let b = b.min(65504.0);
                        assert!((a - b).abs() <= b.abs() / 2048.0 + 3.0e-8, "{}: {a} {b}", read.name);
                    }
                }
            }
        }
        assert_eq!(read.layer("Environment").expect("there").data.iter().fold(0.0_f32, |m, &v| m.max(v)), 65504.0);
    });
}

#[test]
fn the_header_tells_how_the_picture_was_made() {
    in_folder(|folder| {
        let path = folder.join("meta.exr");
        file::write(&path, &sample_picture(8, 8, "combined,crypto_object"), &metadata(), &Options::default())
            .expect("written");
        let header = header(&path);
        let expected = [
            ("File", "shots/Straße.glb"),
            ("Camera", "Camera"),
            ("Frame", "12.5"),
            ("RenderTime", "00:03.25"),
            ("colorInteropID", "lin_rec709_scene"),
            ("penumbra/samples", "64"),
            ("penumbra/seed", "7"),
            ("penumbra/error/display", "2.0000e-2 1.0000e-2 4.0000e-2"),
            ("penumbra/error/rmse", "5.0000e-1 2.5000e-1 1.0000e0"),
            (
                "penumbra/error/rel_mse",
                "not estimable yet: most of it lies in a few pixels, in which rare bright paths were found",
            ),
            ("penumbra/non_finite", "2"),
            ("penumbra/non_finite_first", "3,4,5"),
            ("penumbra/warnings", "a.glb, node: one\ntwo"),
            ("penumbra/settings/max_bounces", "12"),
            // The keys are those that Blender 5.0.1 wrote for the same layer names.
            ("cryptomatte/542cafa/name", "ViewLayer.CryptoObject"),
            ("cryptomatte/542cafa/conversion", "uint32_to_float32"),
            ("cryptomatte/542cafa/hash", "MurmurHash3_32"),
            ("cryptomatte/aa21542/name", "ViewLayer.CryptoAsset"),
            ("cryptomatte/c7dbf5e/name", "ViewLayer.CryptoMaterial"),
            ("cryptomatte/c7dbf5e/manifest", r#"{"Material":"3913209d"}"#),
        ];
        for (name, value) in expected {
            assert_eq!(attribute(&header, name).as_deref(), Some(value), "{name}");
        }
        let own = &header.own_attributes;
        let standard = |text: &Option<exr::meta::attribute::Text>| text.as_ref().map(ToString::to_string);
        assert_eq!(standard(&own.software_name).as_deref(), Some(Metadata::SOFTWARE));
        assert_eq!(standard(&own.owner).as_deref(), Some("Studio"));
        assert_eq!(standard(&own.capture_date).as_deref(), Some("2000:02:29 00:00:00"));
        assert_eq!(own.comments, None);
        let chromaticities = header.shared_attributes.chromaticities.expect("there");
        assert_eq!((chromaticities.red.0, chromaticities.white.1), (0.64, 0.329));
    });
}

#[test]
fn layers_are_blenders_by_name_and_channel() {
    let picture = sample_picture(4, 4, "all");
    let names: Vec<String> =
        picture.layers.iter().map(|layer| format!("{}.{}", layer.name, layer.channels.concat())).collect();
    // Read from a file of Blender 5.0.1, plus those that are ours.
    let expected = [
        "Combined.RGBA",
        "Depth.Z",
        "Mist.Z",
        "Position.XYZ",
        "Normal.XYZ",
        "UV.UVA",
        "Vector.XYZW",
        "Object Index.X",
        "Material Index.X",
        "Diffuse Direct.RGB",
        "Diffuse Indirect.RGB",
        "Diffuse Color.RGB",
        "Glossy Direct.RGB",
        "Glossy Indirect.RGB",
        "Glossy Color.RGB",
        "Transmission Direct.RGB",
        "Transmission Indirect.RGB",
        "Transmission Color.RGB",
        "Diffuse Light.RGB",
        "Diffuse Light Direct.RGB",
        "Diffuse Light Indirect.RGB",
        "Glossy Light.RGB",
        "Glossy Light Direct.RGB",
        "Glossy Light Indirect.RGB",
        "Transmission Light.RGB",
        "Transmission Light Direct.RGB",
        "Transmission Light Indirect.RGB",
        "Emission.RGB",
        "Environment.RGB",
        "Ambient Occlusion.RGB",
        "Shadow.RGB",
        "Diffuse Direct Unshadowed.RGB",
        "Shadow Catcher.RGB",
        "Debug Sample Count.X",
        "CryptoObject00.rgba",
        "CryptoObject01.rgba",
        "CryptoObject02.rgba",
        "CryptoMaterial00.rgba",
        "CryptoMaterial01.rgba",
        "CryptoMaterial02.rgba",
        "CryptoAsset00.rgba",
        "CryptoAsset01.rgba",
        "CryptoAsset02.rgba",
        "Denoising Normal.XYZ",
        "Denoising Albedo.RGB",
        "Denoising Depth.Z",
    ];
    assert_eq!(names, expected);
    // Of groups there are none here, of errors none in `all`; a Cryptomatte is three layers.
    let once = PASSES.iter().filter(|pass| pass.prefix().is_none() && !pass.is_error());
    assert_eq!(once.count() + 6, expected.len());
}

#[test]
fn single_part_files_are_split_into_their_layers() {
    use exr::prelude::*;
    in_folder(|folder| {
        let path = folder.join("single.exr");
        let list = ["ViewLayer.DiffDir.B", "ViewLayer.DiffDir.G", "ViewLayer.DiffDir.R", "Z", "ViewLayer.Combined.A"];
        let channel = |(i, name): (usize, &&str)| {
            let data = if name.ends_with('A') {
                FlatSamples::F16(vec![f16::from_f32(0.5); 6])
            } else {
                FlatSamples::F32(vec![i as f32; 6])
            };
            AnyChannel::new(*name, data)
        };
        let channels = AnyChannels::sort(list.iter().enumerate().map(channel).collect());
        Image::from_channels((3, 2), channels).write().to_file(&path).expect("written");
        let read = file::read(&path).expect("read");
        let find = |name: &str| read.layers.iter().find(|layer| layer.name == name).expect("there");
        assert_eq!(find("ViewLayer.DiffDir").channels, ["R", "G", "B"]);
        assert_eq!(find("ViewLayer.DiffDir").pixel(3, 2, 1), [2.0, 1.0, 0.0]);
        assert_eq!(find("ViewLayer.Combined").data, [0.5; 6]);
        assert_eq!((find("").channels[0].as_str(), find("").data[5]), ("Z", 3.0));
    });
}

#[test]
fn what_cannot_be_written_or_read_is_told_with_the_files_name() {
    in_folder(|folder| {
        let picture = sample_picture(4, 4, "combined");
        let missing = folder.join("missing/out.exr");
        for result in [
            file::write(&missing, &picture, &metadata(), &Options::default()),
            png::write(&missing, &picture, "Combined"),
            file::read(&missing).map(drop),
        ] {
            let error = result.expect_err("there is no such folder");
            assert!(matches!(error, Error::Io { .. }) && error.to_string().contains("missing/out.exr"), "{error}");
        }
        let empty = Picture { width: 4, height: 4, layers: Vec::new() };
        assert!(file::write(&folder.join("a.exr"), &empty, &metadata(), &Options::default()).is_err());
        assert!(png::write(&folder.join("a.png"), &picture, "Shadow").is_err());

        let path = folder.join("whole.exr");
        file::write(&path, &picture, &metadata(), &Options::default()).expect("written");
        let bytes = fs::read(&path).expect("read");
        for cut in [0, 3, 100, bytes.len() / 2, bytes.len() - 1] {
            let torn = folder.join("torn.exr");
            fs::write(&torn, &bytes[..cut]).expect("written");
            let error = file::read(&torn).expect_err("the file is cut short");
            assert!(error.to_string().contains("torn.exr"), "{error}");
        }
        let names: Vec<_> =
            fs::read_dir(folder).expect("folder").map(|entry| entry.expect("entry").file_name()).collect();
        assert!(names.iter().all(|name| name == "whole.exr" || name == "torn.exr"), "{names:?}");
    });
}

#[test]
fn damaged_files_are_told_and_never_crash() {
    in_folder(|folder| {
        let path = folder.join("damaged.exr");
        let picture = sample_picture(20, 9, "combined,depth,crypto_object");
        let mut state = 5_u32;
        let mut below = |n: usize| {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            ((u64::from(state) * n as u64) >> 32) as usize
        };
        for compression in [Compression::Zip, Compression::Piz] {
            file::write(&path, &picture, &metadata(), &Options { compression, ..Options::default() }).expect("written");
            let whole = fs::read(&path).expect("read");
            let mut errors = 0;
            for _ in 0..400 {
                let mut bytes = whole.clone();
                for _ in 0..=below(3) {
                    let at = below(bytes.len());
                    bytes[at] = below(256) as u8;
                }
                fs::write(&path, &bytes).expect("written");
                if let Err(error) = file::read(&path) {
                    assert!(error.to_string().contains("damaged.exr"), "{error}");
                    errors += 1;
                }
            }
            assert!(errors > 40, "{compression:?}: only {errors} of 400 were noticed");
        }
    });
}

/// A header may promise 29 GB in a file of a few hundred bytes; nothing may be reserved for it.
#[test]
fn headers_that_promise_too_much_are_refused() {
    in_folder(|folder| {
        let path = folder.join("bomb.exr");
        file::write(&path, &sample_picture(2, 2, "combined"), &Metadata::default(), &Options::default())
            .expect("written");
        let mut bytes = fs::read(&path).expect("read");
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|window| window == name).expect("every header has one");
        // Length, then min x, min y, max x, max y.
        let max = at + name.len() + 4 + 8;
        bytes[max..max + 8].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
        fs::write(&path, &bytes).expect("written");
        let error = file::read(&path).expect_err("refused");
        assert!(error.to_string().contains("bomb.exr"), "{error}");
    });
}

#[test]
fn previews_are_srgb() {
    in_folder(|folder| {
        let path = folder.join("preview.png");
        let data = vec![0.0, 0.215_860_5, 1.0, 1.0, 0.25, 0.25, 0.0, 0.5];
        let channels = ["R", "G", "B", "A"].map(String::from).to_vec();
        let layer = Layer { name: "Combined".to_owned(), channels, data, storage: Storage::Color };
        png::write(&path, &Picture { width: 2, height: 1, layers: vec![layer] }, "Combined").expect("written");
        let read = image::open(&path).expect("a PNG").into_rgba8();
        assert_eq!(read.as_raw()[..], [0, 128, 255, 255, 188, 188, 0, 128]);
    });
}

/// Leaves a file of every pass for `tests/python/test_exr_readers.py` in Cargo's temporary folder.
#[test]
fn a_file_for_other_readers() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readers.exr");
    let picture = sample_picture(64, 48, "all");
    file::write(&path, &picture, &metadata(), &Options::default()).expect("written");
    let half = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readers_half.exr");
    file::write(&half, &picture, &metadata(), &Options { half: true, ..Options::default() }).expect("written");
    assert!(path.is_file() && half.is_file());
}
