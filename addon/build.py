#!/usr/bin/env python3
"""Builds the extension: one zip for Blender 4.2 and later, the engine's wheel inside.

    python addon/build.py [--out DIR] [--wheel FILE] [--profile PROFILE]

Needs maturin (pip install maturin) and Rust, unless a wheel is given. Prints the zip's path.
"""

import argparse
import base64
import csv
import hashlib
import io
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Platform of a wheel, as Blender calls it.
PLATFORMS = {
    r"manylinux.*x86_64|linux_x86_64": "linux-x64",
    r"manylinux.*aarch64|linux_aarch64": "linux-arm64",
    r"win_amd64": "windows-x64",
    r"win_arm64": "windows-arm64",
    r"macosx.*x86_64": "macos-x64",
    r"macosx.*arm64": "macos-arm64",
}


def build_wheel(folder, profile):
    """The wheel, built from this checkout."""
    # The USD crates declare a newer Rust than they need (docs/decisions/0001-usd.md).
    command = [sys.executable, "-m", "maturin", "build", "--locked", "--ignore-rust-version"]
    command += ["--profile", profile, "--out", folder]
    subprocess.run(command, cwd=ROOT, check=True, stdout=sys.stderr)
    return next(pathlib.Path(folder).glob("penumbra-*.whl"))


def platform_of(wheel):
    """Blender's name for the platform that a wheel is for."""
    for pattern, name in PLATFORMS.items():
        if re.search(pattern, wheel.name):
            return name
    raise SystemExit(f"{wheel.name} is for a platform that Blender does not run on")


def stamped(wheel, folder):
    """A copy of `wheel` whose version ends in a stamp of what is in it.

    Blender tells installed wheels from new ones by name and version alone: without, an extension that is installed over
    one of the same version keeps the engine of that.
    """
    with zipfile.ZipFile(wheel) as source:
        members = [(info, source.read(info)) for info in source.infolist() if not info.is_dir()]
    record = next(info.filename for info, _ in members if re.fullmatch(r"[^/]+\.dist-info/RECORD", info.filename))
    name, version = record.partition(".dist-info/")[0].rsplit("-", 1)
    contents = hashlib.sha256()
    for info, data in sorted(members, key=lambda member: member[0].filename):
        if info.filename != record:
            contents.update(f"{info.filename}\0{len(data)}\0".encode() + data)
    new = f"{version.partition('+')[0]}+{contents.hexdigest()[:12]}"
    moved = lambda path: re.sub(rf"^{re.escape(f'{name}-{version}')}(\.dist-info|\.data)/", rf"{name}-{new}\1/", path)
    target = folder / wheel.name.replace(f"{name}-{version}-", f"{name}-{new}-", 1)
    rows = []
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for info, data in members:
            if info.filename == record:
                continue
            if info.filename == record.replace("RECORD", "METADATA"):
                data = re.sub(rb"(?m)^Version: .*$", f"Version: {new}".encode(), data, count=1)
            info.filename = moved(info.filename)
            archive.writestr(info, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append((info.filename, f"sha256={digest}", len(data)))
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([*rows, (moved(record), "", "")])
        archive.writestr(moved(record), text.getvalue())
    return target


def build_zip(wheel, out):
    """The extension with `wheel` inside."""
    source = ROOT / "addon" / "penumbra"
    manifest = (source / "blender_manifest.toml").read_text()
    platform = platform_of(wheel)
    manifest = manifest.replace("platforms = []", f'platforms = ["{platform}"]')
    manifest = manifest.replace("wheels = []", f'wheels = ["./wheels/{wheel.name}"]')
    version = re.search(r'^version = "(.*)"', manifest, re.M).group(1)
    target = out / f"penumbra-{version}-{platform}.zip"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        for path in sorted(source.rglob("*.py")):
            archive.write(path, path.relative_to(source))
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            archive.write(ROOT / name, name)
        archive.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    return target


def main():
    parser = argparse.ArgumentParser(description="Builds Penumbra's extension for Blender")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "addon")
    parser.add_argument("--wheel", type=pathlib.Path, help="a wheel that is there already")
    parser.add_argument("--profile", default="release", help="Cargo's profile for the wheel")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        wheel = args.wheel or build_wheel(folder, args.profile)
        kept = args.out / wheel.name
        if wheel.resolve() != kept.resolve():
            shutil.copy(wheel, kept)
        print(build_zip(stamped(kept, pathlib.Path(folder)), args.out))


if __name__ == "__main__":
    main()
