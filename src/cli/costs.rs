//! `--costs`: where the time goes, told in words.

use clap::{Arg, ArgAction};
use penumbra::output::Metadata;
use penumbra::render::Costs;

use super::progress::clock;
use super::say;

pub fn arg() -> Arg {
    Arg::new("costs").long("costs").action(ArgAction::SetTrue).conflicts_with("debug-sample").help(
        "Measure after the render, in some seconds more, what samples spend their time on: bounces, passes, effects",
    )
}

/// Tells people.
pub fn tell(costs: &Costs, metadata: &Metadata) {
    let times: Vec<String> =
        metadata.times.iter().map(|(name, seconds)| format!("{name} {}", clock(*seconds))).collect();
    say::err(format!("time: {}", times.join(", ")));
    say::err(format!("a sample takes a thread {:.2} microseconds, of which", 1e6 * costs.sample));
    for cost in &costs.list {
        let (share, error) = (100.0 * cost.share, 200.0 * cost.error);
        let text = match share > error {
            true if cost.error > 0.0 => format!("{share:.1} % (within {error:.1})"),
            true => format!("{share:.1} %"),
            false => format!("less than can be told, {:.1} %", share.max(0.0) + error),
        };
        say::err(format!("  {}: {text}", cost.name));
    }
}
