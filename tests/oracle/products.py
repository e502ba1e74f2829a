"""The products of a plan, read by others' programs, against `gyrfalcon pointing`.

    cargo build --release
    python3 tests/oracle/products.py target/release/gyrfalcon

Needs brahe, icalendar, pyarrow, spiceypy and numpy from PyPI. Plans two days on the circular Sun,
where pointing and plan follow the same directions to the last digit, and prints the largest
differences; ends with 1 where one is too large.
"""

import csv
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

import brahe
import brahe.ccsds
import icalendar
import numpy
import pyarrow.parquet
import spiceypy

OBLIQUITY = numpy.radians(84381.448 / 3600.0)
ARCSEC = numpy.radians(1.0 / 3600.0)
MISSION = ["--duration", "2d", "--sun", "circular", "--quiet"]
failed = []


def check(name, value, limit, unit):
    good = value <= limit
    if not good:
        failed.append(name)
    print(f"{name}: {value:.3g} {unit}, limit {limit:g}{'' if good else ' FAILED'}")


def product(p, q):
    """Quaternions (x, y, z, w)."""
    a, b = numpy.moveaxis(numpy.asarray(p), -1, 0), numpy.moveaxis(numpy.asarray(q), -1, 0)
    return numpy.stack(
        [
            a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
            a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
            a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
        ],
        axis=-1,
    )


def apart(p, q):
    p, q = numpy.asarray(p), numpy.asarray(q)
    sign = numpy.where(numpy.sum(p * q, axis=-1) < 0.0, -1.0, 1.0)[..., None]
    return 4.0 * numpy.arcsin(0.5 * numpy.linalg.norm(p - sign * q, axis=-1))


def truth(program, start_ns, instants):
    """Boresight to ICRF at instants in ns of TAI, from `pointing`."""
    tilt = numpy.array([numpy.sin(OBLIQUITY / 2), 0.0, 0.0, numpy.cos(OBLIQUITY / 2)])
    found = []
    for first in range(0, len(instants), 2000):
        at = ",".join(f"{(ns - start_ns) // 10**9}.{(ns - start_ns) % 10**9:09d}"
                      for ns in instants[first:first + 2000])
        text = subprocess.run([program, "pointing", *MISSION, "--at", at], check=True,
                              capture_output=True, text=True).stdout
        rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
        found += [[float(row[key]) for key in ("q_x", "q_y", "q_z", "q_w")] for row in rows]
    return product(tilt, numpy.array(found))


def tai_ns(text, leap=37):
    """ns of TAI since 2000-01-01T12 TAI of a UTC text of this decade."""
    whole, _, fraction = text.rstrip("Z").partition(".")
    epoch = datetime.datetime(2000, 1, 1, 12)
    seconds = (datetime.datetime.fromisoformat(whole) - epoch) // datetime.timedelta(seconds=1)
    return (seconds + leap) * 10**9 + int(fraction.ljust(9, "0"))


def between(samples, count=5):
    """Instants between neighbours of every segment, whole microseconds."""
    generator = numpy.random.default_rng(6)
    pick = generator.integers(0, len(samples) - 1, 1500)
    part = generator.random(1500)
    step = [samples[i + 1] - samples[i] for i in pick]
    return sorted({samples[i] + int(p * s) // 1000 * 1000 for i, p, s in zip(pick, part, step)})


def check_aem(program, folder, start_ns):
    lines = (folder / "attitude.aem").read_text().splitlines()
    stated = next(line for line in lines if "errs" in line).split("at most ")[1].split()[0]
    stated = float(stated) * ARCSEC
    for name in ("attitude.aem", "attitude.xml"):
        aem = brahe.ccsds.AEM.from_file(str(folder / name))
        worst, middle = 0.0, 0.0
        for index in range(len(aem.segments)):
            trajectory = aem.segment_to_attitude_trajectory(index)
            rows = rows_of(folder / "attitude.aem")[index]
            instants = [tai_ns(row[0]) for row in rows]

            def attitude(ns):
                whole, rest = divmod(ns, 10**9)
                at = datetime.datetime(2000, 1, 1, 12) + datetime.timedelta(seconds=whole)
                epoch = brahe.Epoch.from_datetime(
                    at.year, at.month, at.day, at.hour, at.minute, float(at.second), float(rest),
                    brahe.TAI)
                q = trajectory.quaternion(epoch)
                return [q.x, q.y, q.z, q.w]

            some = instants[:: max(1, len(instants) // 300)]
            expected = truth(program, start_ns, some)
            found = numpy.array([attitude(ns) for ns in some])
            direct, conjugate = apart(found, expected), apart(found * [-1, -1, -1, 1], expected)
            sense = "as written" if direct.max() < conjugate.max() else "conjugate"
            worst = max(worst, min(direct.max(), conjugate.max()))
            inside = between(instants)[::5]
            found = numpy.array([attitude(ns) for ns in inside])
            if sense == "conjugate":
                found = found * [-1, -1, -1, 1]
            middle = max(middle, apart(found, truth(program, start_ns, inside)).max())
        check(f"brahe, {name}, at samples (quaternion {sense})", worst, 1e-9, "rad")
        check(f"brahe, {name}, between", middle / ARCSEC, stated / ARCSEC, "arcsec")


def rows_of(path):
    segments, inside = [], False
    for line in path.read_text().splitlines():
        if line == "DATA_START":
            segments.append([])
            inside = True
        elif line == "DATA_STOP":
            inside = False
        elif inside:
            segments[-1].append(line.split())
    return segments


def check_samples(program, folder, start_ns):
    worst, middle = 0.0, 0.0
    for rows in rows_of(folder / "attitude.aem"):
        instants = [tai_ns(row[0]) for row in rows]
        numbers = numpy.array([[float(word) for word in row[1:]] for row in rows])
        worst = max(worst, apart(numbers[:, :4], truth(program, start_ns, instants)).max())
        inside = between(instants)
        right = numpy.searchsorted(instants, inside, side="right")
        left = right - 1
        right = numpy.minimum(right, len(instants) - 1)
        a, b = numbers[left, :4], numbers[right, :4]
        ends = numpy.array(instants, dtype=float)
        width = numpy.maximum(ends[right] - ends[left], 1.0)
        part = ((numpy.array(inside, dtype=float) - ends[left]) / width)[:, None]
        half = 0.5 * apart(a, b)[:, None]
        mixed = (numpy.sin(half * (1 - part)) * a + numpy.sin(half * part) * b) / numpy.sin(half)
        middle = max(middle, apart(mixed, truth(program, start_ns, inside)).max())
    check("text, attitude.aem, at samples", worst, 1e-9, "rad")
    check("slerp, attitude.aem, between", middle / ARCSEC, 1.0, "arcsec")


def check_spice(program, folder, start_ns):
    for name in ("clock.tsc", "frame.tf", "attitude.bc"):
        spiceypy.furnsh(str(folder / name))
    # What a leap seconds kernel says of ET - TAI.
    for key, values in (("DELTA_T_A", [32.184]), ("K", [1.657e-3]), ("EB", [1.671e-2]),
                        ("M", [6.239996, 1.99096871e-7])):
        spiceypy.pdpool(f"DELTET/{key}", values)
    segments = rows_of(folder / "attitude.aem")
    worst, middle, by_et, rates = 0.0, 0.0, 0.0, 0.0
    for rows in segments:
        instants = [tai_ns(row[0]) for row in rows]
        omega = numpy.radians([[float(word) for word in row[5:]] for row in rows])
        expected = truth(program, start_ns, instants)
        for index, ns in enumerate(instants):
            matrix, av, _ = spiceypy.ckgpav(-999000, ns / 1000.0, 0.0, "J2000")
            body = numpy.array(matrix) @ numpy.array(av)
            rates = max(rates, numpy.abs(body - omega[index]).max())
            q = spiceypy.m2q(matrix)
            worst = max(worst, apart([-q[1], -q[2], -q[3], q[0]], expected[index]))
        inside = between(instants)
        expected = truth(program, start_ns, inside)
        frame = spiceypy.frmnam(-999000)
        for index, ns in enumerate(inside):
            matrix, av, _ = spiceypy.ckgpav(-999000, ns / 1000.0, 0.0, "J2000")
            q = spiceypy.m2q(matrix)
            middle = max(middle, apart([-q[1], -q[2], -q[3], q[0]], expected[index]))
        for index in range(1, len(instants) - 1, 50):
            et = spiceypy.unitim(instants[index] * 1e-9, "TAI", "ET")
            q = spiceypy.m2q(spiceypy.pxform(frame, "J2000", et))
            exact = truth(program, start_ns, [instants[index]])[0]
            by_et = max(by_et, apart([q[1], q[2], q[3], q[0]], exact))
    coverage = spiceypy.ckcov(str(folder / "attitude.bc"), -999000, True, "INTERVAL", 0.0, "SCLK")
    check("SPICE intervals less segments", abs(spiceypy.wncard(coverage) - len(segments)), 0, "")
    check("SPICE ckgpav, at samples", worst, 1e-9, "rad")
    check("SPICE ckgpav, between", middle / ARCSEC, 1.0, "arcsec")
    check("SPICE angular velocity less the AEM's, at samples", rates, 2e-11, "rad/s")
    check("SPICE pxform by ET, at samples", by_et, 2e-9, "rad")


def check_calendar(folder, timeline):
    calendar = icalendar.Calendar.from_ical((folder / "timeline.ics").read_bytes())
    events = [it for it in calendar.walk("VEVENT")]
    check("icalendar, events less sessions", abs(len(events) - len(timeline["sessions"])), 0, "")
    worst = 0.0
    for event, session in zip(events, timeline["sessions"]):
        assert str(event["UID"]).startswith(session["id"] + "@"), event["UID"]
        assert session["reason"] in str(event["DESCRIPTION"])
        for key, name in (("DTSTART", "start_utc"), ("DTEND", "end_utc")):
            exact = datetime.datetime.fromisoformat(session[name][:26] + "+00:00")
            worst = max(worst, abs((event[key].dt - exact).total_seconds()))
        assert event["DTSTART"].dt.utcoffset() == datetime.timedelta(0)
    check("icalendar, times", worst, 1.0, "s")
    longest = max(len(line) for line in (folder / "timeline.ics").read_bytes().split(b"\r\n"))
    check("icalendar, longest line", longest, 75, "bytes")


def check_parquet(program, folder, timeline):
    table = pyarrow.parquet.read_table(folder / "timeline.parquet")
    print(*(f"  {field.name}: {field.type}" for field in table.schema), sep="\n")
    metadata = table.schema.metadata
    assert metadata[b"mission_sha256"].decode() == timeline["mission_sha256"]
    assert len(table) == len(timeline["sessions"])
    for row, session in zip(table.select(["id", "start_tai_ns", "dwell_s"]).to_pylist(),
                            timeline["sessions"]):
        assert all(row[key] == session[key] for key in row), (row, session)
    utc = table["start_utc"].cast("int64").to_pylist()
    worst = max(abs(ns - (session["start_tai_ns"] - 37 * 10**9 + 946728000 * 10**9))
                for ns, session in zip(utc, timeline["sessions"]))
    check("pyarrow, UTC against TAI", worst, 0, "ns")
    for verb in (["pointing", "--step", "600"], ["transits", "--telescope", "HFT"]):
        path = folder.parent / f"{verb[0]}.parquet"
        base = [program, *verb, *MISSION]
        subprocess.run([*base, "--format", "parquet", "--out", str(path)], check=True)
        text = subprocess.run(base, check=True, capture_output=True, text=True).stdout
        read = pyarrow.parquet.read_table(path)
        expected = list(csv.DictReader(
            line for line in text.splitlines() if not line.startswith("#")))
        assert len(read) == len(expected) and read.column_names == list(expected[0])
        for key in read.column_names:
            if key.endswith(("_utc", "_tdb")):
                texts = [str(numpy.datetime64(ns, "ns")) for ns in read[key].cast("int64").to_pylist()]
                assert texts == [row[key].rstrip("Z") for row in expected], key
                continue
            for value, row in zip(read[key].to_pylist(), expected):
                assert (value is None and row[key] == "") or str(value) == row[key] \
                    or float(value) == float(row[key]), (key, value, row[key])
        print(f"pyarrow, {verb[0]}: {len(expected)} rows, {read.num_columns} columns as in CSV")


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    print("brahe", brahe.__version__, "icalendar", icalendar.__version__, "pyarrow",
          pyarrow.__version__, "spiceypy", spiceypy.__version__, spiceypy.tkvrsn("TOOLKIT"))
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "plan"
        subprocess.run([program, "plan", *MISSION, "--also", "all", "--out", str(folder)],
                       check=True)
        timeline = json.loads((folder / "timeline.json").read_text())
        start_ns = timeline["start_tai_ns"]
        check_samples(program, folder, start_ns)
        check_spice(program, folder, start_ns)
        check_calendar(folder, timeline)
        check_parquet(program, folder, timeline)
        check_aem(program, folder, start_ns)
    sys.exit(1 if failed else 0)


main()
