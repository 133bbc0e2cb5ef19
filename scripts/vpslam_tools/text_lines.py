"""Lines of the text files that sequences and trajectories come with, as people write them: with or
without a byte order mark, a header line, quotes, and line ends of any system.

player/text_lines.h reads them in the same way; tests/unit/odd_files.json is a table of odd ones that
the tests of both go through.
"""

import math
import pathlib
import re

from vpslam_tools.errors import UserError

MAX_SECONDS = 9e9              # the year 2255
MIN_EPOCH_MILLISECONDS = 1e11  # the year 1973


def read(path):
    """The text of a file, without its byte order mark."""
    try:
        content = pathlib.Path(path).read_bytes()
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise UserError(f"{path}: is UTF-16; save it as UTF-8")
    if b"\0" in content:
        raise UserError(f"{path}: is no text, as it holds zero bytes")
    return content.decode("utf-8-sig", errors="replace")


def words(line):
    """The words of a line, which end at blanks and commas; quotes around a word are taken off."""
    return [quoted or plain for quoted, plain in re.findall(r'"([^"]+)"|([^\s,"]+)', line)]


def rows(path, parse):
    """What `parse`, which is given the words of a line, makes of each line that is neither empty nor a
    comment (#). It raises ValueError with what is wrong, as the end of a sentence. A first line that
    it refuses and that begins with a letter is a header, unless it is all that there is."""
    parsed, header = [], None
    for number, line in enumerate(re.split(r"\r\n|\r|\n", read(path)), start=1):
        line = line.split("#")[0].strip()
        if not line:
            continue
        try:
            parsed.append(parse(words(line)))
        except ValueError as error:
            fault = UserError(f"{path}:{number}: {error}")
            if parsed or header or not line.lstrip('"')[0].isalpha():
                raise (header or fault) if not parsed else fault from None
            header = fault
    if header and not parsed:
        raise header
    return parsed


def seconds(word):
    """A time stamp, s. Raises ValueError naming the unit, if it is another."""
    try:
        value = float(word)
    except ValueError:
        raise ValueError(f"'{word}' is no number of seconds") from None
    if not math.isfinite(value):
        raise ValueError(f"'{word}' is no number of seconds")
    if abs(value) >= MIN_EPOCH_MILLISECONDS:
        raise ValueError(f"has the time stamp {word} in {finer_unit(abs(value))}; write seconds")
    if abs(value) > MAX_SECONDS:
        raise ValueError(f"has the time stamp {word}, no time in seconds")
    return value


def finer_unit(value):
    if value < 1e3 * MIN_EPOCH_MILLISECONDS:
        return "milliseconds"
    return "microseconds" if value < 1e6 * MIN_EPOCH_MILLISECONDS else "nanoseconds"
