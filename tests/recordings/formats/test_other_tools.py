"""HDF5, PX4, Parquet, MCAP and ROS files as their own packages write them, through the command's own path to a run log."""

import json
import re
import struct
import sys
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recordings.channels import Span
from recordings.formats.table import FORMATS, Format
from recordings.importing import import_file
from recordings.mapping.mapping import ColumnMapping
from records.errors import BadInput
from records.log import RunLog
from tests.recordings.here import imported_here
from tests.test_project import ROOT
from twinlaw.verbs.doctor import EXTRAS

N = 40
T_S = np.arange(N) * 0.01
RUN = {"u_V": 1.0 + T_S, "q_m": np.sin(T_S)}
STAMPS_NS = [1_716_398_564_000_000_000 + 10_000_000 * k for k in range(N)]


def _log(path: Path, **columns: str) -> RunLog:
    return imported_here(path, ColumnMapping(columns=columns, plant="emps"), Span(from_s=0.0)).log


def _is_the_run(log: RunLog, rows: slice = slice(None)) -> None:
    for name, values in RUN.items():
        np.testing.assert_allclose(log.column(name), values[rows], rtol=1e-6)
    np.testing.assert_allclose(log.t_s - log.t_s[0], T_S[rows] - T_S[rows][0], atol=1e-9)


def _matlab(node: Any, values: Any, kind: str = "double") -> Any:
    node.attrs["MATLAB_class"] = np.bytes_(kind)
    return node


def _hdf5(path: Path, *, scope: bool) -> None:
    """As MATLAB writes version 7.3: turned arrays, texts as numbers, an array of structures by references."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        references = file.create_group("#refs#")
        top = file.create_group("Scope") if scope else file
        _matlab(top.create_dataset("time" if scope else "t_s", data=T_S[None, :]), T_S)
        kept: dict[str, list[Any]] = {"values": [], "label": []}
        for name, values in RUN.items():
            if not scope:
                _matlab(top.create_dataset(name, data=values[None, :]), values)
                continue
            kept["values"].append(_matlab(references.create_dataset(name, data=values[None, :]), values).ref)
            text = np.array([[ord(letter)] for letter in name], dtype="u2")
            kept["label"].append(_matlab(references.create_dataset(f"{name}_l", data=text), text, "char").ref)
        if scope:
            signals = top.create_group("signals")
            for field, entries in kept.items():
                signals.create_dataset(
                    field, data=np.array([[e] for e in entries], dtype=h5py.ref_dtype), dtype=h5py.ref_dtype
                )
        else:
            _matlab(top.create_dataset("K", data=np.eye(3)), 0)
            _matlab(top.create_dataset("ts", data=np.ones((1, 6), "u4")), 0, "timeseries").attrs[
                "MATLAB_object_decode"
            ] = 3
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    path.write_bytes(head + path.read_bytes()[128:])


def _ulog(path: Path) -> None:
    """Two topics of 4 ms and 10 ms, one of them in two instances, by the published definition of the format."""

    def message(kind: str, body: bytes) -> bytes:
        return struct.pack("<HB", len(body), ord(kind)) + body

    stamps_us = [int(5e6 + 1e6 * t) for t in T_S]
    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message("B", bytes(40))
    out += message("F", b"drive:uint64_t timestamp;float[2] control;") + message(
        "F", b"encoder:uint64_t timestamp;float x;"
    )
    for number, (name, instance) in enumerate([("drive", 0), ("encoder", 0), ("encoder", 1)]):
        out += message("A", struct.pack("<BH", instance, number) + name.encode())
    for k, stamp in enumerate(stamps_us):
        out += message("D", struct.pack("<HQff", 0, stamp, RUN["u_V"][k], 0.0))
        out += message("D", struct.pack("<HQf", 1, stamp, 0.0)) + message(
            "D", struct.pack("<HQf", 2, stamp, RUN["q_m"][k])
        )
    path.write_bytes(out + message("O", struct.pack("<H", 7)))


def _parquet(path: Path) -> None:
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    stamps = pa.array(STAMPS_NS, type=pa.timestamp("ns"))
    arm = [{"joint": {"q_mm": 1e3 * q}} for q in RUN["q_m"]]
    columns = {"stamp": stamps, "u [mV]": 1e3 * RUN["u_V"], "arm": arm, "mode": ["fly"] * N}
    parquet.write_table(pa.table(columns), path)


def _arrow(path: Path) -> None:
    pa = pytest.importorskip("pyarrow")
    write = {".orc": "orc.write_table"}.get(path.suffix, "feather.write_feather")
    module, name = write.split(".")
    stamps = pa.array(STAMPS_NS, type=pa.timestamp("ns"))
    getattr(pytest.importorskip(f"pyarrow.{module}"), name)(
        pa.table({"stamp": stamps, "u [mV]": 1e3 * RUN["u_V"], "q_m": RUN["q_m"]}), str(path)
    )


def _parquet_arrays(path: Path) -> None:
    """Both signals as arrays of one length, at times of day past midnight."""
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    day_ns = [(86_399_900_000_000 + 10_000_000 * k) % 86_400_000_000_000 for k in range(N)]
    times = pa.array(day_ns, type=pa.time64("ns"))
    arrays = [[u, 1e3 * q] for u, q in zip(*RUN.values(), strict=True)]
    parquet.write_table(pa.table({"when": times, "both": arrays}), path)


def _mcap_json(path: Path) -> None:
    writer_module = pytest.importorskip("mcap.writer")
    with path.open("wb") as stream:
        writer = writer_module.Writer(stream, chunk_size=400)
        writer.start()
        schema = writer.register_schema("rig", "jsonschema", b"{}")
        rig, blob = writer.register_channel("/rig", "json", schema), writer.register_channel("/blob", "cbor", schema)
        for k, ns in enumerate(STAMPS_NS):
            content = {"u_V": RUN["u_V"][k], "arm": {"q": [0.0, RUN["q_m"][k]]}, "mode": "fly", "on": True}
            writer.add_message(rig, ns, json.dumps(content).encode(), ns)
            writer.add_message(blob, ns, b"\x00", ns)
        writer.finish()


def _bag(path: Path, storage: str = "SQLITE3", packed: str = "NONE") -> None:
    """A ROS 2 bag: numbers by topic, and a stamped vector that is recorded 3 ms late."""
    rosbag2, typesys = pytest.importorskip("rosbags.rosbag2"), pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    number, vector = store.types["std_msgs/msg/Float64"], store.types["geometry_msgs/msg/Vector3Stamped"]
    header, time, xyz = (
        store.types[f"{name}"]
        for name in ("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "geometry_msgs/msg/Vector3")
    )
    writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin[storage])
    if packed != "NONE":
        writer.set_compression(rosbag2.CompressionMode[packed], rosbag2.CompressionFormat.ZSTD)
    with writer:
        topics = [
            writer.add_connection(name, kind.__msgtype__, typestore=store)
            for name, kind in (("/u_V", number), ("/arm", vector))
        ]
        for k, ns in enumerate(STAMPS_NS):
            arm = vector(header(time(ns // 10**9, ns % 10**9), "base"), xyz(0.0, RUN["q_m"][k], 0.0))
            writer.write(topics[0], ns, store.serialize_cdr(number(RUN["u_V"][k]), number.__msgtype__))
            writer.write(topics[1], ns + 3_000_000, store.serialize_cdr(arm, vector.__msgtype__))


def _mcap_of_ros(path: Path) -> None:
    """The MCAP file of a ROS 2 bag, without its folder."""
    _bag(path.parent / "bag", "MCAP")
    (path.parent / "bag" / "bag.mcap").rename(path)


CASES: Mapping[str, tuple[str, Callable[[Path], None], dict[str, str]]] = {
    "version 7.3": ("run.mat", lambda path: _hdf5(path, scope=False), {}),
    "version 7.3, a scope": ("run.mat", lambda path: _hdf5(path, scope=True), {}),
    "PX4": ("run.ulg", _ulog, {"u_V": "drive.control[0]", "q_m": "encoder[1].x"}),
    "Parquet": ("run.parquet", _parquet, {}),
    "Parquet of arrays": ("run.parquet", _parquet_arrays, {"u_V": "both[0]", "q_m": "both[1]*0.001"}),
    "Feather": ("run.feather", _arrow, {}),
    "Arrow": ("run.arrow", _arrow, {}),
    "ORC": ("run.orc", _arrow, {}),
    "MCAP of JSON": ("run.mcap", _mcap_json, {"q_m": "/rig.arm.q[1]"}),
    "ROS 2 bag": ("run", _bag, {"q_m": "arm.vector.y"}),
    "ROS 2 bag of MCAP": ("run", lambda path: _bag(path, "MCAP"), {"q_m": "arm.vector.y"}),
    "ROS 2 bag, packed": ("run", lambda path: _bag(path, packed="MESSAGE"), {"q_m": "arm.vector.y"}),
    "MCAP of ROS 2": ("run.mcap", _mcap_of_ros, {"q_m": "arm.vector.y"}),
}


def test_a_bag_s_file_without_what_describes_it_is_refused_with_the_command_that_makes_it(tmp_path: Path) -> None:
    _bag(tmp_path / "run")
    alone = (tmp_path / "run" / "run.db3").rename(tmp_path / "alone.db3")
    for path in (alone, tmp_path / "run"):
        (tmp_path / "run" / "metadata.yaml").unlink(missing_ok=True)
        with pytest.raises(BadInput, match="no metadata") as caught:
            _log(path, q_m="arm.vector.y")
        assert str(path) in caught.value.where
        assert "ros2 bag reindex" in caught.value.remedy


@pytest.mark.parametrize("case", CASES)
def test_each_format_gives_the_run_in_si_units(case: str, tmp_path: Path) -> None:
    name, write, columns = CASES[case]
    write(tmp_path / name)
    _is_the_run(_log(tmp_path / name, **columns))


@pytest.mark.parametrize("damaged", [False, True])
def test_a_log_of_px4_with_a_hole_in_it_is_said_to_be_damaged(damaged: bool, tmp_path: Path) -> None:
    pytest.importorskip("pyulog")
    _ulog(tmp_path / "run.ulg")
    content = bytearray((tmp_path / "run.ulg").read_bytes())
    if damaged:
        content[600:700] = bytes(100)
    (tmp_path / "run.ulg").write_bytes(content)
    told = imported_here(
        tmp_path / "run.ulg",
        ColumnMapping(columns={"u_V": "drive.control[0]", "q_m": "encoder[1].x"}, plant="emps"),
        Span(),
    ).found
    assert ("the file is damaged: what could not be read is passed over" in told) is damaged


@pytest.mark.parametrize("missing", [0, 1, 9])
def test_a_log_of_px4_that_ends_within_a_message_gives_what_it_has(missing: int, tmp_path: Path) -> None:
    # Truth: the last message has five bytes; without nine the one before it, the last reading of q_m, is cut too.
    pytest.importorskip("pyulog")
    _ulog(tmp_path / "run.ulg")
    whole = (tmp_path / "run.ulg").read_bytes()
    (tmp_path / "run.ulg").write_bytes(whole[: len(whole) - missing])
    mapping = ColumnMapping(columns={"u_V": "drive.control[0]", "q_m": "encoder[1].x"}, plant="emps")
    done = imported_here(tmp_path / "run.ulg", mapping, Span(from_s=0.0))
    _is_the_run(done.log, slice(0, len(done.log.t_s)))
    assert len(done.log.t_s) == N - (missing == 9)
    assert any("ends early" in told for told in done.found) is (missing > 0)


def test_a_topic_in_two_instances_is_asked_for(tmp_path: Path) -> None:
    _ulog(tmp_path / "run.ulg")
    with pytest.raises(BadInput, match=r"encoder\[0\]\.x .* or encoder\[1\]\.x"):
        _log(tmp_path / "run.ulg", u_V="drive.control[0]", q_m="encoder.x")


def test_an_mcap_file_that_ends_early_gives_what_it_has(tmp_path: Path) -> None:
    _mcap_json(tmp_path / "run.mcap")
    whole = (tmp_path / "run.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) // 2])
    done = imported_here(tmp_path / "cut.mcap", ColumnMapping(columns={"q_m": "q[1]"}, plant="emps"))
    _is_the_run(done.log, slice(0, len(done.log.t_s)))
    assert any("ends early" in told for told in done.found)


@pytest.mark.parametrize("suffix", [".mat", ".h5", ".ulg", ".parquet", ".feather", ".mcap", ".bag", ".db3"])
@pytest.mark.parametrize("content", [b"", b"no such format at all" * 20, bytes(range(256)) * 4, None])
def test_a_file_of_another_kind_is_one_clear_line(suffix: str, content: bytes | None, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / f"run{suffix}").write_bytes(content)
    with pytest.raises(BadInput) as refused:
        _log(tmp_path / f"run{suffix}")
    assert f"run{suffix}" in str(refused.value) or str(tmp_path) in str(refused.value)


NEEDING = [(suffixes[0], entry) for suffixes, entry in FORMATS.items() if entry.package]


@pytest.mark.parametrize(("suffix", "entry"), NEEDING, ids=[suffix for suffix, _ in NEEDING])
def test_a_package_that_is_not_installed_is_named_with_its_extra(
    suffix: str, entry: Format, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, entry.package or "", None)
    (tmp_path / f"run{suffix}").write_bytes(b"x\0")  # a table of text under that ending needs none
    for read in (imported_here, import_file):
        with pytest.raises(BadInput, match=rf"no package {entry.package} .*twinlaw\[{entry.extra}\]"):
            read(tmp_path / f"run{suffix}", ColumnMapping())


def test_the_extras_of_the_table_are_declared_installed_for_the_tests_and_known_to_the_doctor() -> None:
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    extras = {entry.extra for _, entry in NEEDING}
    assert set(re.findall(r"\w+", declared["logs"][0])) == {"twinlaw", "matlab", *extras}
    assert "twinlaw[cores,logs]" in declared["test"]
    for _, entry in NEEDING:
        named = [requirement.lower().replace("-", "_") for requirement in declared[entry.extra]]
        assert any(requirement.startswith(entry.package or "?") for requirement in named)
    assert extras <= set(EXTRAS)
