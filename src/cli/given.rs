//! What every command that renders is given: camera, size, frame and settings.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};
use penumbra::settings::{SETTINGS, Settings};

use super::scene;

/// Which view of the scene.
pub fn view_args() -> [Arg; 3] {
    [
        Arg::new("camera")
            .long("camera")
            .value_name("NAME|PATH")
            .help("Camera to look through; that of the file's own render settings or the first unless set"),
        Arg::new("size")
            .long("size")
            .value_name("WxH")
            .value_parser(parse_size)
            .help("Size of the picture in pixels; that of the file's own render settings, or 960 across, unless set"),
        Arg::new("frame")
            .long("frame")
            .value_name("F")
            .value_parser(scene::parse_frame)
            .allow_negative_numbers(true)
            .help("Frame (USD: time code; glTF: 24 per second); USD's first, or glTF's pose at rest, unless set"),
    ]
}

/// A flag for each row of SETTINGS.
pub fn setting_args() -> impl Iterator<Item = Arg> {
    SETTINGS.iter().map(|def| {
        let flag = def.name.replace('_', "-");
        let default = if def.default.is_empty() { String::new() } else { format!(" [default: {}]", def.default) };
        let arg = Arg::new(def.name).long(flag).value_name(def.value_name).help(format!("{}{default}", def.help));
        arg.allow_negative_numbers(true)
    })
}

/// The settings that were typed; a mistake ends the program as clap's own do, by the usage of `command`.
pub fn settings(args: &ArgMatches, command: fn() -> Command) -> Settings {
    let mut settings = Settings::default();
    for def in SETTINGS {
        if let Some(text) = args.get_one::<String>(def.name)
            && let Err(what) = def.set(&mut settings, text)
        {
            let flag = def.name.replace('_', "-");
            let message = format!("invalid value '{text}' for '--{flag} <{}>': {what}", def.value_name);
            let command = command();
            let name = format!("penumbra {}", command.get_name());
            command.bin_name(name).error(clap::error::ErrorKind::ValueValidation, message).exit();
        }
    }
    if args.value_source("spp") != Some(ValueSource::CommandLine) {
        settings.without_spp();
    }
    settings
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once('x').ok_or("expected WIDTHxHEIGHT, as 960x540")?;
    match (width.parse(), height.parse()) {
        (Ok(width), Ok(height)) if width > 0 && height > 0 => Ok([width, height]),
        _ => Err("expected WIDTHxHEIGHT of at least 1x1, as 960x540".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert_eq!(parse_size("960x540"), Ok([960, 540]));
        assert!(parse_size("0x540").is_err() && parse_size("960").is_err());
    }
}
