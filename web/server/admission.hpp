// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
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
/// have one of its tokens if it wants one: one to look, one to command too. A WebSocket to look may also
/// come from kApplications and from origins of the user's choice.
class Admission {
 public:
  /// Origins of applications that draw such data, admitted on this computer alone: Foxglove and Lichtblick
  /// in a browser, and programs on Electron, such as Lichtblick, whose windows are loaded from a file. A
  /// browser sends "null" with a page from the disk.
  static constexpr std::array<std::string_view, 3> kApplications{
      "https://app.foxglove.dev", "https://lichtblick-suite.github.io", "file://"};

  /// This computer alone, without a token; or, if `listen` is not empty, all who reach this address of
  /// an interface and have the token.
  /// @param origins  further ones whose WebSockets may look.
  Admission(const std::string& listen, std::uint16_t port, std::vector<std::string> origins = {});

  /// Whether it is an origin of one site as browsers send it: SCHEME://HOST[:PORT] in small letters,
  /// without a path. "null" may be anybody's.
  static bool is_origin_text(std::string_view text);

  /// @param host  the header Host. A foreign name that leads here (DNS rebinding) is none of ours.
  bool is_name(std::string_view host) const;
  /// @param origin  the header Origin, as a browser sends it with what a page asks for.
  bool is_origin(std::string_view origin) const;
  /// What a WebSocket of a page of this origin may do at most.
  Right right_of_origin(std::string_view origin) const;

  bool wants_token() const { return !look_.empty(); }
  /// Takes the same time wherever the first difference is.
  Right right_of(std::string_view token) const;
  /// @param authorization  the header: "Bearer TOKEN".
  bool is_bearer(std::string_view authorization) const;

  /// What to type into a browser. The token stands after '#', which browsers send to nobody.
  std::string address(Right right) const;

 private:
  std::vector<std::string> names_;    ///< As in Host; the first one is printed.
  std::vector<std::string> viewers_;  ///< Origins that may look.
  std::string look_;                  ///< Tokens of this start; empty: nobody has to show one.
  std::string command_;
};

}  // namespace rosflight::web::server
