"""seal and unseal: a text that nobody reads by accident, and that nobody changes unnoticed."""

from __future__ import annotations

import hashlib
import hmac
import secrets

from ves_twin.core.errors import InvalidInputError

KEY_BYTES = 32
TAG_BYTES = 32
NONCE_BYTES = 16


def new_key() -> str:
    """A random key, as text."""
    return secrets.token_hex(KEY_BYTES)


def seal(text: str, key: str) -> bytes:
    """Nonce, tag and the text under a key stream: SHAKE-256 of key and nonce, HMAC-SHA-256 over it.

    It keeps the truth from eyes and programs that should not see it yet, and shows tampering. The
    key lies in a file beside the suite, so it is no protection against a thief.
    """
    nonce = secrets.token_bytes(NONCE_BYTES)
    hidden = _with_stream(text.encode(), key, nonce)
    return nonce + _tag(hidden, key, nonce) + hidden


def unseal(sealed: bytes, key: str, what: str) -> str:
    """The text.

    Args:
        sealed: what `seal` gave.
        key: the same key.
        what: named in the error.

    Raises:
        InvalidInputError: another key, or content that was changed.
    """
    nonce, tag = sealed[:NONCE_BYTES], sealed[NONCE_BYTES : NONCE_BYTES + TAG_BYTES]
    hidden = sealed[NONCE_BYTES + TAG_BYTES :]
    if not hmac.compare_digest(tag, _tag(hidden, key, nonce)):
        raise InvalidInputError(what, "a seal that this key does not open", "the suite's own key")
    return _with_stream(hidden, key, nonce).decode()


def _tag(hidden: bytes, key: str, nonce: bytes) -> bytes:
    return hmac.new(key.encode(), nonce + hidden, hashlib.sha256).digest()


def _with_stream(text: bytes, key: str, nonce: bytes) -> bytes:
    stream = hashlib.shake_256(key.encode() + nonce).digest(len(text))
    return bytes(a ^ b for a, b in zip(text, stream, strict=True))
