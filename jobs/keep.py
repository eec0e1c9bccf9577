"""Where answers wait: one file a job under its key, so that a sweep goes on where it was and no old answer meets a changed question."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from jobs.job import Answer
from records.errors import BadInput
from records.files import write_atomic

STAMP = "run.json"


class Keep(Protocol):
    """What can keep answers, each by its job's name and key."""

    def load(self, name: str, key: str) -> Answer | None:
        """The answer, or None where it is not there whole."""

    def save(self, name: str, key: str, answer: Answer, time_s: float) -> None:
        """Keep the answer, which took `time_s`; raises BadInput where that is impossible."""


@dataclass(frozen=True)
class Answers:
    """FOLDER/KEY.json, an answer each."""

    folder: Path

    def load(self, name: str, key: str) -> Answer | None:
        """The answer under this key, if it is there and can be read."""
        content = _read(self.folder / f"{key}.json")
        return content.get("answer")

    def save(self, name: str, key: str, answer: Answer, time_s: float) -> None:
        """Write it whole; raises BadInput where that is impossible."""
        write_atomic(self.folder / f"{key}.json", json.dumps({"job": name, "time_s": time_s, "answer": answer}) + "\n")


@dataclass(frozen=True)
class Folders:
    """FOLDER/NAME/, an answer each that is a mapping of file names to texts, with run.json written last.

    `file` is what is read of it when it comes back: the answer is then that one file's text alone.
    """

    folder: Path
    file: str

    def load(self, name: str, key: str) -> Answer | None:
        """{file: its text} if run.json bears this key and every file is as it was written."""
        place = self.folder / name
        stamp = _read(place / STAMP)
        files = stamp.get("files")
        if stamp.get("key") != key or not isinstance(files, Mapping):
            return None
        for entry, digest in files.items():
            try:
                content = (place / entry).read_bytes()
            except OSError:
                return None
            if _digest(content) != digest:
                return None
        return {self.file: (place / self.file).read_text(encoding="utf-8")}

    def save(self, name: str, key: str, answer: Answer, time_s: float) -> None:
        """Write its files, then the stamp; what an earlier answer left besides is removed. Raises BadInput where that is impossible."""
        place = self.folder / name
        before = _read(place / STAMP).get("files", {})
        try:
            (place / STAMP).unlink(missing_ok=True)
            for entry in set(before) - set(answer):
                (place / entry).unlink(missing_ok=True)
        except OSError as error:
            got = error.strerror or str(error)
            raise BadInput("answers", str(place), got, "a folder of answers", "choose another folder") from error
        for entry, text in answer.items():
            write_atomic(place / entry, text)
        files = {entry: _digest(text.encode("utf-8")) for entry, text in answer.items()}
        write_atomic(place / STAMP, json.dumps({"key": key, "time_s": round(time_s, 2), "files": files}) + "\n")


def _read(path: Path) -> Mapping[str, Any]:
    """A JSON object, or an empty one where there is none that can be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
