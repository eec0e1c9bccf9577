"""Consistent Overhead Byte Stuffing, the host's side (S. Cheshire, M. Baker, IEEE/ACM Trans. Networking 7(2), 1999)."""


def cobs_encode(data: bytes) -> bytes:
    """Encode `data` into bytes without zeros; no delimiter is added."""
    encoded = bytearray()
    pieces = data.split(b"\0")
    for index, piece in enumerate(pieces):
        rest = piece
        while len(rest) > 254 or (len(rest) == 254 and index < len(pieces) - 1):
            encoded += b"\xff" + rest[:254]
            rest = rest[254:]
        encoded += bytes([len(rest) + 1]) + rest
    return bytes(encoded)


def cobs_decode(encoded: bytes) -> bytes | None:
    """Decode one block without its delimiter; None for an empty block, a zero inside, or a block past the end."""
    if not encoded or 0 in encoded:
        return None
    decoded = bytearray()
    at = 0
    while at < len(encoded):
        code = encoded[at]
        block = encoded[at + 1 : at + code]
        if len(block) != code - 1:
            return None
        decoded += block
        at += code
        if code != 0xFF and at < len(encoded):
            decoded.append(0)
    return bytes(decoded)
