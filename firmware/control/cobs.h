/*
 * Consistent Overhead Byte Stuffing (S. Cheshire, M. Baker, IEEE/ACM Trans. Networking 7(2), 1999).
 *
 * Encoded data holds no zero byte, so that a zero on the line always ends a frame and a receiver that joined
 * late, or lost bytes, is back in step at the next one.
 */
#ifndef COBS_H
#define COBS_H

#include <stddef.h>
#include <stdint.h>

#define COBS_DELIMITER 0u
#define COBS_ENCODED_MAX(length) ((length) + (length) / 254u + 1u)
#define COBS_INVALID SIZE_MAX

/* Encode `length` bytes into `to` (room for COBS_ENCODED_MAX(length)); returns the encoded length, without delimiter. */
size_t cobs_encode(const uint8_t *from, size_t length, uint8_t *to);

/*
 * Decode `length` bytes without their delimiter into `to` (room for `length`; may be `from` itself).
 * Returns the decoded length, or COBS_INVALID for an empty block, a zero inside, or a block that runs past the end.
 */
size_t cobs_decode(const uint8_t *from, size_t length, uint8_t *to);

#endif
