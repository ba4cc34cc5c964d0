// SPDX-License-Identifier: BSD-3-Clause
#include "log/checksums.hpp"

#include <openssl/evp.h>
#include <zlib.h>

#include <stdexcept>

namespace rosflight::log {
namespace {

/// OpenSSL fails here only without memory or without its default algorithms.
void require(bool done) {
  if (!done) throw std::runtime_error("OpenSSL: cannot compute SHA-256");
}

}  // namespace

std::uint32_t crc32(Bytes bytes, std::uint32_t before) {
  if (bytes.empty()) return before;  // zlib returns 0 for a null pointer.
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

void Sha256::Free::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
}

void Sha256::update(Bytes bytes) {
  require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
}

std::string Sha256::hex() const {
  const std::unique_ptr<evp_md_ctx_st, Free> copy(EVP_MD_CTX_new());
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  require(copy && EVP_MD_CTX_copy_ex(copy.get(), context_.get()) == 1 &&
          EVP_DigestFinal_ex(copy.get(), digest.data(), &size) == 1);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : std::span(digest).first(size)) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

}  // namespace rosflight::log
