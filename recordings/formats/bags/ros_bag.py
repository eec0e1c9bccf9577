"""ROS 2 bags (a folder, or its .db3 file) and ROS 1 bags (.bag), by way of the optional package rosbags."""

from collections.abc import Iterator
from pathlib import Path

from recordings.formats.bags.messages import Message, contents_of
from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput


def read(path: Path, asked: TextLayout) -> Contents:
    """The numbers of every topic; raises BadInput when rosbags is not installed, and for what is no bag."""
    package("rosbags", "ros", path)
    bag = path.parent if path.suffix == ".db3" else path
    folder = path if path.is_dir() else path.parent
    if path.suffix != ".bag" and not (folder / "metadata.yaml").exists():
        got, remedy = "no metadata.yaml beside it", "copy that too, or `ros2 bag reindex FOLDER` makes it anew"
        if path.is_dir():
            got, remedy = "no metadata.yaml in it", f"name a file, or the folder of a bag; {remedy.partition('or ')[2]}"
        raise BadInput("folder" if path.is_dir() else "ROS bag", str(path), got, "a ROS 2 bag", remedy)
    unread: dict[str, str] = {}
    return contents_of(_messages(bag, unread), unread)


def _messages(bag: Path, unread: dict[str, str]) -> Iterator[Message]:
    """All messages in their order; a bag that names no types is taken as of ROS 2's latest."""
    highlevel, typesys = package("rosbags.highlevel", "ros", bag), package("rosbags.typesys", "ros", bag)
    try:
        types = typesys.get_typestore(typesys.Stores.LATEST)
        with highlevel.AnyReader([bag], default_typestore=types) as reader:
            for connection, recorded_ns, data in reader.messages():
                if connection.topic in unread:
                    continue
                try:
                    yield Message(connection.topic, recorded_ns, reader.deserialize(data, connection.msgtype))
                except (KeyError, highlevel.AnyReaderError):
                    unread[connection.topic] = f"of the type {connection.msgtype}, which the bag does not define"
    except Exception as error:  # the package's classes, SQLite's, and those of damaged files
        got = f"no bag ({type(error).__name__}: {error})"[:300]
        raise BadInput(
            "ROS bag", str(bag), got, "a ROS bag", "name its folder, with metadata.yaml in it, or a .bag file"
        ) from error
