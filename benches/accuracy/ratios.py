"""How well the jackknife knows the error of a shadow, a ratio of two means, where few samples can be lit at all.

    target/test-venv/bin/python benches/accuracy/ratios.py

A sample is lit with a probability, by light that varies by a log-normal factor, and it arrives with another: the shadow
is the light that arrives over all of it, and 1 where there is none. Over many pixels, the mean of the estimated variances
over the variance that shadows have; beside it the same by linearisation, leverages counted (a least squares' HC2), and
how many of the eight replicates have light, in the mean.
"""

import numpy as np

REPLICATES = 8
PIXELS = 20_000


def ratio(lit, light):
    return np.where(light > 0, lit / np.where(light > 0, light, 1), 1.0)


def jackknife(lit, light):
    every, k = ratio(lit.sum(1), light.sum(1)), REPLICATES
    without = ratio(lit.sum(1)[:, None] - lit, light.sum(1)[:, None] - light)
    pseudo = k * every[:, None] - (k - 1) * without
    return pseudo.var(1, ddof=1) / k


def linearised(lit, light):
    every, whole = ratio(lit.sum(1), light.sum(1))[:, None], np.where(light.sum(1) > 0, light.sum(1), 1)[:, None]
    share = light / whole
    alone = share > 1 - 1e-9
    return ((lit - every * light) ** 2 / whole**2 / np.where(alone, 1, 1 - share)).sum(1)


def main():
    random = np.random.default_rng(1)
    print("| samples | could be lit | arrives | replicates with light | jackknife | linearised |")
    print("|---|---|---|---|---|---|")
    for samples in (16, 64, 256):
        for could in (0.01, 0.03, 0.1, 0.3, 1.0):
            for arrives in (0.1, 0.5, 0.9):
                shape = (PIXELS, REPLICATES, samples // REPLICATES)
                each = np.where(random.random(shape) < could, np.exp(random.standard_normal(shape)), 0)
                lit = (each * (random.random(shape) < arrives)).sum(2)
                light = each.sum(2)
                true = ratio(lit.sum(1), light.sum(1)).var()
                ratios = [(of(lit, light).mean() / true) for of in (jackknife, linearised)]
                count = (light > 0).sum(1).mean()
                print(f"| {samples} | {could} | {arrives} | {count:.1f} | {ratios[0]:.2f} | {ratios[1]:.2f} |")


if __name__ == "__main__":
    main()
