//! `penumbra compare`: two pictures of one scene, pass by pass.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use penumbra::compare::{self, Comparison, Options, Side};
use penumbra::output::{exr, report};

use super::{Outcome, say};

pub fn command() -> Command {
    let file =
        |name: &'static str, value: &'static str| Arg::new(name).value_name(value).value_parser(value_parser!(PathBuf));
    Command::new("compare")
        .about("Compare two pictures of one scene pass by pass: bias, RMSE, relMSE, PSNR, FLIP, worst pixels, verdict")
        .arg(file("a", "A.exr").required(true).help("The reference"))
        .arg(file("b", "B.exr").required(true).help("The picture that is held against it"))
        .arg(
            file("more-a", "FILE")
                .long("more-a")
                .action(ArgAction::Append)
                .help("The reference with another seed, any number: its noise is known from how they differ"),
        )
        .arg(
            file("more-b", "FILE")
                .long("more-b")
                .action(ArgAction::Append)
                .help("The other picture with another seed, likewise; without them noise is that of the error passes"),
        )
        .arg(
            Arg::new("passes")
                .long("passes")
                .value_name("LIST")
                .value_delimiter(',')
                .help("Passes to compare, as render has them, or names of layers [default: all that both have]"),
        )
        .arg(
            Arg::new("among")
                .long("among")
                .value_name("N")
                .default_value("1")
                .value_parser(value_parser!(u32).range(1..))
                .help(
                    "How many passes you judge altogether, by other calls too: chance alone makes one of many differ",
                ),
        )
        .arg(Arg::new("no-flip").long("no-flip").action(ArgAction::SetTrue).help("Leave out FLIP, which takes longest"))
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print JSON"))
        .arg(
            file("html", "DIR")
                .long("html")
                .help("Write index.html in this folder: a page to look at both pictures and their differences"),
        )
        .arg(
            Arg::new("strict")
                .long("strict")
                .action(ArgAction::SetTrue)
                .help("End with 1 where a pass differs, lacks its counterpart, or has values that are not finite"),
        )
}

pub fn run(args: &ArgMatches) -> anyhow::Result<Outcome> {
    let files = |first: &str, more: &str| -> Vec<PathBuf> {
        let more = args.get_many::<PathBuf>(more).into_iter().flatten();
        args.get_one::<PathBuf>(first).into_iter().chain(more).cloned().collect()
    };
    let (a, b) = (files("a", "more-a"), files("b", "more-b"));
    let passes = args.get_many::<String>("passes").into_iter().flatten().map(|name| name.trim().to_owned());
    let among = args.get_one("among").copied().unwrap_or(1);
    let options = Options { passes: passes.collect(), flip: !args.get_flag("no-flip"), among };
    let comparison = compare::compare(read(&a)?, read(&b)?, &options)
        .map_err(|sizes| anyhow!("{} and {}: {sizes}", a[0].display(), b[0].display()))?;
    let known = |name: &String| {
        let pass = compare::pass_of(name);
        let ends = |full: &str| full == pass || full.strip_suffix(&pass).is_some_and(|rest| rest.ends_with('.'));
        comparison
            .pairs
            .iter()
            .map(|pair| &pair.name)
            .chain(&comparison.only_a)
            .chain(&comparison.only_b)
            .any(|n| ends(n))
    };
    if let Some(missing) = options.passes.iter().find(|name| !known(name)) {
        return Err(anyhow!("{} and {}: neither has a pass '{missing}'", a[0].display(), b[0].display()));
    }
    if comparison.pairs.is_empty() {
        let lists = [("A", &comparison.only_a), ("B", &comparison.only_b)].map(|(side, names)| {
            format!("{side} has {}", if names.is_empty() { "none".into() } else { names.join(", ") })
        });
        return Err(anyhow!("{} and {} have no pass in common: {}", a[0].display(), b[0].display(), lists.join("; ")));
    }
    let name = |files: &[PathBuf]| files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>();
    let (a, b) = (name(&a), name(&b));
    if args.get_flag("json") {
        say::out(format!("{:#}\n", report::compare::json(&comparison, &a, &b)));
    } else {
        say::out(report::compare::table(&comparison));
    }
    if let Some(folder) = args.get_one::<PathBuf>("html") {
        std::fs::create_dir_all(folder).with_context(|| format!("{}: the folder can't be made", folder.display()))?;
        let page = folder.join("index.html");
        report::compare_page::write(&page, &comparison, &a, &b)?;
        say::err(format!("{}: open it in a browser", page.display()));
    }
    if args.get_flag("strict")
        && let Some(what) = fault(&comparison)
    {
        return Err(anyhow!("{} and {}: {what}", a[0], b[0]));
    }
    Ok(Outcome::Done)
}

/// One side, of all its renders.
fn read(files: &[PathBuf]) -> anyhow::Result<Side> {
    let renders = files.iter().map(|file| exr::read(Path::new(file))).collect::<Result<Vec<_>, _>>()?;
    Side::of(renders).map_err(|index| {
        anyhow!("{}: not of the size and with the passes of {}", files[index].display(), files[0].display())
    })
}

/// What `--strict` does not let pass.
fn fault(comparison: &Comparison) -> Option<String> {
    let of = |is: fn(&compare::Figures) -> bool| {
        let names: Vec<&str> =
            comparison.pairs.iter().filter(|pair| is(&pair.figures)).map(|pair| pair.name.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let differs = of(|figures| figures.judgement.verdict == compare::Verdict::Differs);
    let not_finite = of(|figures| figures.not_finite != [0, 0]);
    let lacking = [&comparison.only_a, &comparison.only_b, &comparison.unlike].map(|names| names.join(", ")).join(" ");
    let lacking = Some(lacking.trim().to_owned()).filter(|names| !names.is_empty());
    differs
        .map(|names| format!("{names}: more than noise"))
        .or_else(|| not_finite.map(|names| format!("{names}: not finite")))
        .or_else(|| lacking.map(|names| format!("{names}: without counterpart")))
}
