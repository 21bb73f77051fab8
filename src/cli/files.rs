//! Where pictures go: names with frame numbers, and what must not be overwritten.

use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::ArgMatches;
use penumbra::error::Place;
use penumbra::film::Picture;
use penumbra::output::{self, Metadata, exr};

/// The EXR file and the preview of one frame.
pub struct Files {
    /// The EXR.
    pub out: PathBuf,
    /// The PNG, if asked for.
    pub preview: Option<PathBuf>,
}

impl Files {
    /// The files that `args` ask for at `frame`, or the scene by its `own` name, which it says at the place. In a sequence every name gets the frame's number, for
    /// a single frame those that hold `#`.
    ///
    /// # Errors
    /// Names of another kind of file, which could be the scene's own, the environment's, or a place
    /// that can't be written.
    pub fn of(args: &ArgMatches, frame: Option<f64>, own: Option<(&str, &Place)>) -> anyhow::Result<Self> {
        let sequence = args.contains_id("frames");
        let path = |name: &str| args.get_one::<PathBuf>(name).map(|path| numbered(path, frame, sequence)).transpose();
        let out = match (path("output")?, own) {
            (Some(out), _) => {
                require(&out, "exr", "-o")?;
                output::check_writable(&out)?;
                out
            }
            (None, Some((own, place))) => {
                let own = numbered(Path::new(own), frame, sequence).and_then(|out| {
                    require(&out, "exr", "a render")?;
                    output::check_writable(&out)?;
                    Ok(out)
                });
                own.map_err(|error| anyhow!("{place}: its picture {error:#}"))?
            }
            (None, None) => bail!("-o OUT.exr is missing, and the scene names no picture of its own"),
        };
        let preview = path("preview")?;
        if let Some(preview) = &preview {
            require(preview, "png", "--preview")?;
            output::check_writable(preview)?;
        }
        let same = |a: &Path, b: &Path| {
            std::fs::canonicalize(a).ok().is_some_and(|a| std::fs::canonicalize(b).ok() == Some(a))
        };
        if let Some(environment) = args.get_one::<PathBuf>("environment")
            && (same(environment, &out) || preview.as_ref().is_some_and(|preview| same(environment, preview)))
        {
            bail!("{}: the environment would be overwritten by the picture", environment.display());
        }
        Ok(Self { out, preview })
    }
}

/// True for names of that kind of file.
pub fn is_of_kind(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn require(path: &Path, extension: &str, flag: &str) -> anyhow::Result<()> {
    if !is_of_kind(path, extension) {
        bail!("{}: {flag} writes .{extension} files, the name must end so", path.display());
    }
    Ok(())
}

/// `path` with the frame number: in place of a run of `#`, or in a sequence as `.0001` behind the stem.
fn numbered(path: &Path, frame: Option<f64>, sequence: bool) -> anyhow::Result<PathBuf> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let hashes: String = name.chars().skip_while(|c| *c != '#').take_while(|c| *c == '#').collect();
    let new = match frame {
        Some(frame) if !hashes.is_empty() => {
            let width = hashes.len();
            name.replacen(&hashes, &format!("{frame:0width$}"), 1)
        }
        Some(frame) if sequence => {
            let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "exr"));
            format!("{stem}.{frame:04}.{extension}")
        }
        None if !hashes.is_empty() => bail!("{}: {hashes} needs --frame or --frames", path.display()),
        _ => return Ok(path.to_owned()),
    };
    Ok(path.with_file_name(new))
}

/// Writes the picture to `out`, or where that fails (a full disk, a folder that went away) to the
/// system's temporary folder, so that no render is lost; returns where it is.
pub fn save(out: &Path, picture: &Picture, metadata: &Metadata, options: &exr::Options) -> anyhow::Result<PathBuf> {
    let Err(error) = exr::write(out, picture, metadata, options) else { return Ok(out.to_owned()) };
    let rescue = std::env::temp_dir().join(out.file_name().unwrap_or_default());
    let rescued = rescue != out && !rescue.exists() && exr::write(&rescue, picture, metadata, options).is_ok();
    let place = if rescued { format!("is saved as {}", rescue.display()) } else { "is lost".into() };
    let fate = format!("{}: can't be written, the render {place}", out.display());
    Err(anyhow::Error::from(error).context(fate))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_numbers_go_where_the_hashes_are() {
        let name = |path: &str, frame: Option<f64>, sequence: bool| {
            numbered(Path::new(path), frame, sequence).map(|path| path.display().to_string()).ok()
        };
        assert_eq!(name("a/b.exr", Some(7.0), true).as_deref(), Some("a/b.0007.exr"));
        assert_eq!(name("a/b.exr", Some(7.0), false).as_deref(), Some("a/b.exr"));
        assert_eq!(name("a/b_###.exr", Some(7.0), false).as_deref(), Some("a/b_007.exr"));
        assert_eq!(name("a/b.exr", None, false).as_deref(), Some("a/b.exr"));
        assert_eq!(name("a/b_###.exr", None, false), None);
    }
}
