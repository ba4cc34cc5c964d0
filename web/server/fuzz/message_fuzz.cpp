// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a message of a viewer, a list of protocols and a range: understood, or refused as a whole.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "web/server/byte_range.hpp"
#include "web/server/foxglove.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight::web::server;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const foxglove::Request request = foxglove::parse_request(text);
  const bool empty = request.subscribe.empty() && request.unsubscribe.empty() &&
                     !request.get_parameters && !request.command;
  if (!request.complaint.empty() && !empty) std::abort();
  // A complaint goes back to the client, whatever bytes it quotes.
  if (foxglove::status_error(request.complaint).empty()) std::abort();
  static_cast<void>(foxglove::parse_token(text));
  const auto protocol = foxglove::chosen_protocol(text);
  if (protocol && text.find(*protocol) == std::string_view::npos) std::abort();
  constexpr std::uint64_t kSize = 1000;
  if (const auto range = byte_range(text, kSize)) {
    if (range->length == 0 || range->start + range->length > kSize) std::abort();
  }
  return 0;
}
