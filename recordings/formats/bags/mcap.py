"""MCAP files with ROS 2, Protobuf or JSON messages, by way of the optional package mcap and its decoders."""

import json
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from recordings.formats.bags.messages import Message, contents_of
from recordings.formats.optional import package
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput

DECODERS = ("mcap_ros2", "mcap_ros1", "mcap_protobuf")  # packages of the mcap project, those that are installed
Decoder = Callable[[bytes], Any]


def read(path: Path, asked: TextLayout) -> Contents:
    """The numbers of every topic that a decoder knows; a file that ends early gives what it has, which is said. Raises BadInput."""
    package("mcap", "ros", path)
    found: list[str] = []
    unread: dict[str, str] = {}
    contents = contents_of(_messages(path, found, unread), unread)
    if not contents.signals and found:
        raise BadInput("MCAP file", str(path), found[0], "an MCAP file with messages", "record or download it again")
    return Contents(contents.signals, found=(*found, *contents.found), unread=unread)


def _messages(path: Path, found: list[str], unread: dict[str, str]) -> Iterator[Message]:
    reader, factories = package("mcap.reader", "ros", path), _factories()
    decoders: dict[int, Decoder | None] = {}
    try:
        with path.open("rb") as stream:
            # In the file's order, so that one without an end is read as far as it goes.
            for schema, channel, message in reader.NonSeekingReader(stream).iter_messages(log_time_order=False):
                if channel.id not in decoders:
                    decoders[channel.id] = _decoder(channel.message_encoding, schema, factories)
                    if decoders[channel.id] is None:
                        unread[channel.topic] = (
                            f"encoded as {channel.message_encoding}, which no installed decoder knows"
                        )
                decode = decoders[channel.id]
                if decode is not None:
                    yield Message(channel.topic, message.log_time, decode(message.data))
    except OSError as error:
        raise BadInput(
            "MCAP file", str(path), error.strerror or str(error), "a readable file", "check the path"
        ) from error
    except Exception as error:  # each decoder has classes of its own
        found.append(f"the file ends early or is damaged ({type(error).__name__}: {error})"[:200])


def _factories() -> list[Any]:
    return [package(f"{name}.decoder", "ros", name).DecoderFactory() for name in DECODERS if find_spec(name)]


def _decoder(encoding: str, schema: Any, factories: list[Any]) -> Decoder | None:
    if encoding == "json":
        return json.loads
    return next((decoder for factory in factories if (decoder := factory.decoder_for(encoding, schema))), None)
