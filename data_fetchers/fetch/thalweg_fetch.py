#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fetches a DEM: thalweg_fetch.py SOURCE --bbox W S E N --out FILE.tif (see --help).

The command `thalweg fetch` becomes this program; it also runs by itself, with Debian's Python and python3-gdal. Exit code 0:
done; 2: something the user can mend; 3: a server failed; 1: a defect. Failures are one line on standard error."""
import argparse
import ctypes
import errno
import os
import signal
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))

from problems import ServerError, UserError  # noqa: E402

FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT)


class Stopped(BaseException):
    """A signal."""

    def __init__(self, number):
        super().__init__(number)
        self.number = number


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise UserError(f"{message} (see thalweg fetch --help)")


def parser():
    p = Parser(prog="thalweg fetch", allow_abbrev=False)
    p.add_argument("source")
    p.add_argument("--bbox", nargs="+")
    p.add_argument("--point", nargs="+")
    p.add_argument("--radius-m")
    p.add_argument("--outline")
    p.add_argument("--out", default="")
    p.add_argument("--crs")
    p.add_argument("--cell-m")
    for flag in ("fill-voids", "yes", "force", "offline", "refresh", "dry-run", "quiet", "json", "end-with-parent"):
        p.add_argument(f"--{flag}", action="store_true")
    p.add_argument("--cache")
    p.add_argument("--base-url")
    p.add_argument("--allow-host", action="append", default=[])
    p.add_argument("--retries", default="4")
    p.add_argument("--retry-delay-s", default="1")
    p.add_argument("--timeout-s", default="30")
    p.add_argument("--threads", default="0")
    return p


def joined(words):
    """`--bbox -84 36 -83 37` as `--bbox=-84,36,-83,37`: argparse takes some negative numbers for options."""
    takes, result, i = {"--bbox": 4, "--point": 2, "--radius-m": 1, "--cell-m": 1}, [], 0
    while i < len(words):
        count = takes.get(words[i], 0)
        values = words[i + 1:i + 1 + count]
        if count and len(values) == count and not any(value.startswith("--") for value in values):
            result.append(f"{words[i]}={','.join(values)}")
            i += count + 1
        else:
            result.append(words[i])
            i += 1
    return result


def numbers(name, words, count):
    values = [word for part in words for word in part.split(",") if word.strip()]
    try:
        found = [float(value) for value in values]
    except ValueError:
        found = []
    if len(found) != count or len(values) != count:
        raise UserError(f"{name} needs {count} number{'s' * (count > 1)}, not '{' '.join(values)}'")
    return found


def number(options, name, least, most, whole=False, least_excluded=False):
    """A checked number in place of the word the user gave."""
    word = getattr(options, name.replace("-", "_"))
    if word is None:
        return
    value = numbers(f"--{name}", [word], 1)[0]
    if not (least <= value <= most) or (whole and value != int(value)) or (least_excluded and value == least):
        kind = "a whole number" if whole else "a number"
        raise UserError(f"--{name} needs {kind} {'above' if least_excluded else 'from'} {least:g} to {most:g}, not {word}")
    setattr(options, name.replace("-", "_"), int(value) if whole else value)


def checked(words):
    options = parser().parse_args(joined(words))
    number(options, "retries", 0, 100, whole=True)
    number(options, "threads", 0, 64, whole=True)
    number(options, "retry-delay-s", 0, 600)
    number(options, "timeout-s", 0, 3600, least_excluded=True)
    number(options, "cell-m", 0, 100000, least_excluded=True)
    return options


def region_of(options):
    """The box in degrees, and the outline if one was given."""
    import region
    given = [name for name in ("bbox", "point", "outline") if getattr(options, name) is not None]
    if len(given) != 1:
        raise UserError("where? give one of --bbox W S E N, --point LON LAT with --radius-m R, or --outline FILE")
    if (options.radius_m is not None) != (given == ["point"]):
        raise UserError("--point LON LAT and --radius-m R go together")
    if given == ["bbox"]:
        return region.box(*numbers("--bbox", options.bbox, 4)), None
    if given == ["point"]:
        return region.around(*numbers("--point", options.point, 2), *numbers("--radius-m", [options.radius_m], 1)), None
    outline, box = region.outline(options.outline)
    return box, outline


def fetch(words, output_holder):
    """All of it. Returns what is to be said at the end and the text of the provenance."""
    options = checked(words)
    import reader
    reader.prepare_gdal(options.timeout_s)
    import cache
    import catalogue
    import fetcher
    import output
    import provenance
    import progress
    import web
    if options.end_with_parent:
        ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG
    source = catalogue.find(options.source, options.base_url, options.allow_host)
    box, outline = region_of(options)
    out = None if options.dry_run else output.Output(options.out, options.force)
    output_holder.append(out)
    bar = progress.Progress(options.quiet or options.json)
    output_holder.append(bar)
    way_out = web.Web(source.hosts, options.retries, options.timeout_s, options.retry_delay_s)
    work = fetcher.Fetcher(source, options, way_out, cache.Cache(options.cache or cache.default_folder()), bar)
    try:
        canvas, counts, jobs = work.run(box, outline)
    except fetcher.Planned as plan:
        return [], f"{plan}\n", True
    bar.status("writing")
    text = out.write(canvas, lambda checksum: provenance.of(source, words, canvas, counts, jobs, out.name, checksum))
    said = [f"thalweg: warning: {note}" for note in counts["notes"]]
    if not options.quiet and not options.json:
        said.append(f"thalweg: {options.out} has {canvas.grid.cols} x {canvas.grid.rows} cells from {len(jobs)} "
                    f"tile{'s' * (len(jobs) > 1)} of {source.name}; licence and citation are in {options.out}.json")
    bar.clear()
    return said, text, options.json


def stop(number, _):
    raise Stopped(number)


def without_secrets(text):
    for name, value in os.environ.items():
        if name.endswith(("_KEY", "_TOKEN", "_PASSWORD")) and len(value) > 3:
            text = text.replace(value, "…")
    return text


def message_of(problem):
    """Exit code and sentence."""
    if isinstance(problem, (UserError, ServerError)):
        return problem.code, str(problem)
    if isinstance(problem, Stopped):
        return 128 + problem.number, "stopped by a signal; nothing was written, and the cache keeps what was read"
    if isinstance(problem, MemoryError):
        return 2, "not enough memory for this size; fetch a smaller region"
    if isinstance(problem, ImportError):
        return 2, f"fetching needs python3-gdal and python3-numpy ({problem})"
    if isinstance(problem, OSError) and problem.errno is not None:
        where = f" '{problem.filename}'" if problem.filename else ""
        return 2, f"the disk is full: cannot write{where}" if problem.errno in FULL else f"{problem.strerror}{where}"
    return 1, f"a defect of thalweg, please report it: {type(problem).__name__}: {problem}"


def main(words):
    for number_ in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number_, stop)
    sys.unraisablehook = lambda _: None  # files that GDAL closes on a full disk: the reading back tells
    begun = []
    try:
        said, text, prints = fetch(words, begun)
        code = 0
        if prints:
            sys.stdout.write(text)
            sys.stdout.flush()
    except SystemExit as ended:
        return ended.code or 0
    except BaseException as problem:  # the caller shows one line, whatever it is
        for number_ in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number_, signal.SIG_IGN)
        code, sentence = message_of(problem)
        said = [f"thalweg: error: {' '.join(without_secrets(sentence).split())}"]
        for each in begun:
            if each is not None:
                each.discard() if hasattr(each, "discard") else each.clear()
    for line in said:
        print(line, file=sys.stderr)
    sys.stderr.flush()
    return code


if __name__ == "__main__":
    # Not sys.exit: threads that wait for a server would be waited for.
    os._exit(main(sys.argv[1:]))
