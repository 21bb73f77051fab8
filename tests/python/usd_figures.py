"""How much of what Penumbra reads of stages is compared with OpenUSD, and what differs.

    cargo build --ignore-rust-version
    target/test-venv/bin/python tests/python/usd_figures.py [STAGE ...]

judges the stages of the tests (those of the repository, and the usd-wg assets where they are) or those that are
named, as test_usd_core.py and test_usd_looks.py do, and prints the stages, the numbers that were compared, and every
difference. Exits with 1 where there is one.
"""

import sys
from pathlib import Path

import numpy as np
import test_usd_core
import test_usd_looks
from pxr import Tf
from usd_judge import Stage

compared = 0


def counting(near):
    """`near`, and how many numbers it was asked of."""

    def count(found, expected, *rest):
        global compared
        compared += np.asarray(expected).size
        return near(found, expected, *rest)

    return count


def main():
    test_usd_core.near = test_usd_looks.near = counting(test_usd_core.near)
    stages = [Path(path) for path in sys.argv[1:]] or test_usd_core.STAGES
    judged, closed, differences = 0, [], []
    for path in stages:
        if path.name in test_usd_core.NOT_JUDGED:
            closed.append((path.name, test_usd_core.NOT_JUDGED[path.name]))
            continue
        try:
            Stage(path)
        except Tf.ErrorException as error:
            closed.append((path.name, f"usd-core does not open it: {str(error).splitlines()[0]}"))
            continue
        judged += 1
        differences += [f"{path.name}: {what}" for judge in (test_usd_core, test_usd_looks) for what in judge.judge(path)]
    print(f"{judged} stages, {compared} numbers compared, {len(differences)} differences")
    for name, why in closed:
        print(f"not judged: {name}: {why}")
    for what in differences:
        print(what)
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
