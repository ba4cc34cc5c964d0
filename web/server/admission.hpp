// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rosflight::web::server {

/// 128 random bits, as 32 hexadecimal digits.
std::string random_token();

/// What a viewer may do.
enum class Right : std::uint8_t { kNone, kLook, kCommand };

/// Which requests a server answers: those that call it by its own name, come from its own page, and
/// have one of its tokens if it wants one: one to look, one to command too.
class Admission {
 public:
  /// This computer alone, without a token; or, if `listen` is not empty, all who reach this address of
  /// an interface and have the token.
  Admission(const std::string& listen, std::uint16_t port);

  /// @param host  the header Host. A foreign name that leads here (DNS rebinding) is none of ours.
  bool is_name(std::string_view host) const;
  /// @param origin  the header Origin, as a browser sends it with what a page asks for.
  bool is_origin(std::string_view origin) const;

  bool wants_token() const { return !look_.empty(); }
  /// Takes the same time wherever the first difference is.
  Right right_of(std::string_view token) const;
  /// @param authorization  the header: "Bearer TOKEN".
  bool is_bearer(std::string_view authorization) const;

  /// What to type into a browser. The token stands after '#', which browsers send to nobody.
  std::string address(Right right) const;

 private:
  std::vector<std::string> names_;  ///< As in Host; the first one is printed.
  std::string look_;                ///< Tokens of this start; empty: nobody has to show one.
  std::string command_;
};

}  // namespace rosflight::web::server
