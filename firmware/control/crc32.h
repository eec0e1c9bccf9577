/* CRC-32 of zlib and Ethernet: polynomial 0x04C11DB7, reflected, start and final inversion (ITU-T V.42, 8.1.1.6.2). */
#ifndef CRC32_H
#define CRC32_H

#include <stddef.h>
#include <stdint.h>

uint32_t crc32_of(const uint8_t *data, size_t length);

#endif
