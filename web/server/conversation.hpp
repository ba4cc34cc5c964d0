// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "web/server/admission.hpp"
#include "web/server/command_desk.hpp"
#include "web/server/live_data.hpp"

namespace rosflight::web::server {

/// What is sent between the server and one viewer, in the Foxglove protocol v1 (foxglove.hpp), without
/// the socket.
///
/// Where a token is wanted, the viewer's first message has to be it, and nothing is sent before. What is
/// new stays in LiveData until all before it has been sent, so a viewer that does not read costs no
/// memory: it misses states.
class Conversation {
 public:
  /// A viewer with more answers unread is disconnected.
  static constexpr std::size_t kMaxUnreadTexts = 32;

  /// @param desk  nullptr: nothing can be commanded.
  /// @param session  the same for all viewers of one start of the server.
  /// @param viewer  its number, from 1.
  /// @param most  what it may do at most, also with a token.
  Conversation(const LiveData& live, CommandDesk* desk, const Admission& admission,
               const std::string& session, std::uint64_t viewer, Right most = Right::kCommand);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  bool is_admitted() const { return right_ != Right::kNone; }
  /// Something else runs now, and next() has nothing more to send: the viewer has to begin again.
  bool is_over() const { return over_ && answers_.empty(); }

  /// A message of the viewer; `is_text` if its frame has that type.
  /// @returns whether the viewer stays connected.
  [[nodiscard]] bool on_message(std::string_view message, bool is_text);

  struct Frame {
    bool is_text{};
    std::string head;          ///< All of a text; of a binary message what precedes its contents.
    LiveData::Shared message;  ///< Its contents; nullptr for a text.
  };
  /// The next frame to send, once the one before has been sent; nothing: there is nothing new.
  std::optional<Frame> next();

 private:
  void greet();
  void take_news();
  void take_answers();
  bool on_request(std::string_view message);
  bool on_parameters(const std::vector<std::string>& names, const std::string& id);
  bool on_command(CommandDesk::What what, const std::string& id);
  /// @returns whether the viewer stays connected.
  bool complain(const std::string& what);

  const LiveData& live_;
  CommandDesk* desk_;
  const Admission& admission_;
  const std::string& session_;
  std::uint64_t viewer_;
  Right most_;
  Right right_;
  std::optional<bool> unsaved_;  ///< As last sent to the viewer; likewise the next one.
  std::optional<CommandDesk::Control> control_;
  bool over_{false};
  std::deque<std::string> texts_;
  std::deque<LiveData::Shared> messages_;
  std::deque<std::string> answers_;  ///< After the messages that show what was done.
  LiveData::Cursor cursor_;
  std::vector<std::optional<std::uint32_t>> subscriptions_;  ///< The viewer's ids, by channel.
};

}  // namespace rosflight::web::server
