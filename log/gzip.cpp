// SPDX-License-Identifier: BSD-3-Clause
#include "log/gzip.hpp"

#include <zlib.h>

#include <limits>

#include "log/output_file.hpp"

namespace rosflight::log {

std::string gzip(Bytes bytes) {
  constexpr int kGzip = 16;  // beside the window's bits: with the head of RFC 1952
  constexpr int kMemory = 9;
  z_stream stream{};
  const bool fits = bytes.size() <= std::numeric_limits<uInt>::max();
  if (!fits || deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, kMemory,
                            Z_DEFAULT_STRATEGY) != Z_OK) {
    throw LogError("cannot pack " + std::to_string(bytes.size()) + " bytes");
  }
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = const_cast<Bytef*>(bytes.data());  // NOLINT: zlib reads only
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());  // NOLINT: bytes either way
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END)
    throw LogError("cannot pack " + std::to_string(bytes.size()) + " bytes");
  return packed;
}

}  // namespace rosflight::log
