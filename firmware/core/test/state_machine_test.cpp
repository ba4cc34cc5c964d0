// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/state_machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

// The expectation is written a second time, from the tables of the behaviour of ROSflight 2.0.1
// (error word, state machine, arming) and what docs/compatibility.md adds to them, not from the
// rows of state_machine.hpp.
namespace rosflight::core {
namespace {

constexpr std::uint16_t kRcLostBit = 0x04;
constexpr std::array<State, kStateCount> kStates{
    State::kInit,     State::kPreflight,   State::kArmed,  State::kError,
    State::kFailsafe, State::kCalibrating, State::kSaving, State::kMotorTest};
constexpr std::array<Event, kEventCount> kEvents{
    Event::kInitialized, Event::kRcFound,     Event::kRcLost,
    Event::kError,       Event::kNoError,     Event::kArm,
    Event::kArmInAir,    Event::kDisarm,      Event::kCalibrationComplete,
    Event::kSaved,       Event::kSaveFailed,  Event::kCalibrationFailed,
    Event::kMotorTest,   Event::kMotorTestEnd};

std::vector<ArmRequest> all_requests() {
  std::vector<ArmRequest> requests;
  requests.reserve(8);
  for (int k = 0; k < 8; ++k) requests.push_back({(k & 1) != 0, (k & 2) != 0, (k & 4) != 0});
  return requests;
}

/// What can be seen of the machine.
struct Seen {
  State state{State::kInit};
  bool armed{}, failsafe{}, error{};
  std::uint16_t errors{};
  bool operator<(const Seen& o) const {
    return std::tie(state, armed, failsafe, error, errors) <
           std::tie(o.state, o.armed, o.failsafe, o.error, o.errors);
  }
  bool operator==(const Seen& o) const { return !(*this < o) && !(o < *this); }
};

Seen look(const StateMachine& m) {
  return {m.state(), m.armed(), m.failsafe(), m.error(), m.errors()};
}

std::ostream& operator<<(std::ostream& out, const Seen& s) {
  return out << "state " << static_cast<int>(s.state) << " armed " << s.armed << " failsafe "
             << s.failsafe << " flag " << s.error << " word 0x" << std::hex << s.errors << std::dec;
}

/// The sheet, state by state. `owner` collects what is left to the firmware.
class Sheet {
 public:
  explicit Sheet(const Seen& start) : now{start} {}

  void event(Event e, const ArmRequest& r) {
    const State before = now.state;
    const std::uint16_t word_before = now.errors;
    switch (now.state) {
      case State::kInit:
        if (e == Event::kInitialized) now.state = State::kPreflight;
        break;
      case State::kPreflight:
        preflight(e, r);
        break;
      case State::kError:
        in_error(e);
        break;
      case State::kCalibrating:
        calibrating(e, r);
        break;
      case State::kSaving:
        saving(e, r);
        break;
      case State::kMotorTest:
        testing(e);
        break;
      case State::kArmed:
        flying(e);
        break;
      case State::kFailsafe:
        failing(e);
        break;
    }
    if (now.state != before || now.errors != word_before) owner |= action::kSendStatus;
  }

  void set_bit(std::uint16_t bit) {
    const std::uint16_t before = now.errors;
    now.errors |= bit;
    if (now.errors != before) owner |= action::kSendStatus;
    event(Event::kError, {});
  }

  void clear_bit(std::uint16_t bit) {
    if ((now.errors & bit) == 0) return;
    now.errors = static_cast<std::uint16_t>(now.errors & ~bit);
    owner |= action::kSendStatus;
    event(now.errors != 0 ? Event::kError : Event::kNoError, {});
  }

  Seen now;
  Actions owner{0};

 private:
  void preflight(Event e, const ArmRequest& r) {
    if (e == Event::kRcFound) {
      now.failsafe = false;
      clear_bit(kRcLostBit);
    }
    if (e == Event::kRcLost) set_bit(kRcLostBit);
    if (e == Event::kError) {
      now.error = true;
      now.state = State::kError;
    }
    if (e == Event::kArmInAir) arm_in_air();
    if (e == Event::kMotorTest) now.state = State::kMotorTest;
    if (e != Event::kArm) return;
    if (!r.ready) {
      owner |= action::kRefuse;
    } else if (r.calibrate_gyro) {
      now.state = State::kCalibrating;
      owner |= action::kCalibrateGyro;
    } else {
      save_or_arm(r);
    }
  }
  void in_error(Event e) {
    if (e == Event::kRcLost) set_bit(kRcLostBit);
    if (e == Event::kRcFound) {
      now.failsafe = false;
      clear_bit(kRcLostBit);
    }
    if (e == Event::kNoError) {
      now.error = false;
      now.state = State::kPreflight;
    }
    if (e == Event::kArm) owner |= action::kRefuse;
    if (e == Event::kArmInAir) {
      constexpr std::uint16_t kNoFlight = 0x01 | 0x02 | kRcLostBit;
      if ((now.errors & kNoFlight) != 0) {
        owner |= action::kRefuse;
      } else {
        arm_in_air();
      }
    }
  }
  void arming(Event e, Actions ended) {
    if (e == Event::kDisarm) {
      owner |= ended;
      now.state = State::kPreflight;
    }
    if (e == Event::kRcLost) set_bit(kRcLostBit);
    if (e == Event::kError) {
      owner |= ended;
      now.error = true;
      now.state = State::kError;
    }
  }
  void calibrating(Event e, const ArmRequest& r) {
    if (e == Event::kCalibrationComplete) ask_again(r);
    if (e == Event::kCalibrationFailed) now.state = State::kPreflight;
    arming(e, action::kStopCalibration);
  }
  void saving(Event e, const ArmRequest& r) {
    if (e == Event::kSaved) ask_again(r);
    if (e == Event::kSaveFailed) {
      owner |= action::kRefuseStorage;
      now.state = State::kPreflight;
    }
    arming(e, action::kNone);
  }
  void testing(Event e) {
    const bool ends = e == Event::kMotorTestEnd || e == Event::kArm || e == Event::kError;
    if (ends) owner |= action::kStopMotorTest;
    if (e == Event::kMotorTestEnd || e == Event::kArm) now.state = State::kPreflight;
    if (e == Event::kRcLost) set_bit(kRcLostBit);
    if (e == Event::kError) {
      now.error = true;
      now.state = State::kError;
    }
  }
  void ask_again(const ArmRequest& r) {
    if (r.ready) return save_or_arm(r);
    owner |= action::kRefuse;
    now.state = State::kPreflight;
  }
  void save_or_arm(const ArmRequest& r) {
    if (!r.save) return arm();
    now.state = State::kSaving;
    owner |= action::kSave;
  }
  void flying(Event e) {
    if (e == Event::kRcLost) {
      now.failsafe = true;
      now.state = State::kFailsafe;
      set_bit(kRcLostBit);
    }
    if (e == Event::kDisarm) disarm(now.error ? State::kError : State::kPreflight);
    if (e == Event::kError) now.error = true;
    if (e == Event::kNoError) now.error = false;
  }
  void failing(Event e) {
    if (e == Event::kRcFound) {
      now.failsafe = false;
      now.state = State::kArmed;
      clear_bit(kRcLostBit);
    }
    if (e == Event::kDisarm) disarm(State::kError);
    if (e == Event::kError) now.error = true;
  }
  void arm_in_air() {
    owner |= action::kInAir;
    arm();
  }
  void arm() {
    now.armed = true;
    now.state = State::kArmed;
    owner |= action::kArm;
  }
  void disarm(State next) {
    now.armed = false;
    now.state = next;
    owner |= action::kDisarm;
  }
};

enum class Feed {
  kAnything,       ///< Every event at any time, from INIT on.
  kAsTheFirmware,  ///< Initialised first; error events through the word, RC lost by event.
};

/// Every configuration that any sequence of events, error bits and updates leads to.
std::map<Seen, StateMachine> reachable(Feed feed) {
  std::map<Seen, StateMachine> found;
  std::vector<StateMachine> open{StateMachine{}};
  if (feed == Feed::kAsTheFirmware) open.front().handle(Event::kInitialized);
  found.emplace(look(open.front()), open.front());
  while (!open.empty()) {
    const StateMachine from = open.back();
    open.pop_back();
    std::vector<StateMachine> next;
    for (const Event e : kEvents) {
      if (feed == Feed::kAsTheFirmware && (e == Event::kError || e == Event::kNoError)) continue;
      for (const ArmRequest& r : all_requests()) {
        next.push_back(from);
        next.back().handle(e, r);
      }
    }
    for (int bit = 0; bit < 8; ++bit) {
      if (feed == Feed::kAsTheFirmware && 1 << bit == kRcLostBit) continue;
      next.push_back(from);
      next.back().set_error(static_cast<Error>(1 << bit));
      next.push_back(from);
      next.back().clear_error(static_cast<Error>(1 << bit));
    }
    next.push_back(from);
    next.back().update();
    for (const StateMachine& m : next) {
      if (found.emplace(look(m), m).second) open.push_back(m);
    }
  }
  return found;
}

class EveryConfiguration : public testing::Test {
 protected:
  const std::map<Seen, StateMachine> all_{reachable(Feed::kAnything)};
};

class EveryFlownConfiguration : public testing::Test {
 protected:
  const std::map<Seen, StateMachine> all_{reachable(Feed::kAsTheFirmware)};
};

TEST_F(EveryConfiguration, AnswersEveryEventAndArmRequestAsTheSheetSays) {
  std::size_t compared = 0;
  for (const auto& [seen, machine] : all_) {
    for (const Event e : kEvents) {
      for (const ArmRequest& r : all_requests()) {
        StateMachine m = machine;
        const Actions owner = m.handle(e, r);
        Sheet sheet(seen);
        sheet.event(e, r);
        ASSERT_EQ(look(m), sheet.now) << seen << " event " << static_cast<int>(e);
        ASSERT_EQ(owner, sheet.owner) << seen << " event " << static_cast<int>(e);
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, all_.size() * kEventCount * 8);
}

TEST_F(EveryConfiguration, SetsAndClearsEveryErrorBitAsTheSheetSays) {
  for (const auto& [seen, machine] : all_) {
    for (int bit = 0; bit < 8; ++bit) {
      const auto error = static_cast<Error>(1 << bit);
      StateMachine set = machine;
      Sheet sheet_set(seen);
      sheet_set.set_bit(static_cast<std::uint16_t>(1 << bit));
      ASSERT_EQ(set.set_error(error), sheet_set.owner) << seen << " bit " << bit;
      ASSERT_EQ(look(set), sheet_set.now) << seen << " bit " << bit;

      StateMachine cleared = machine;
      Sheet sheet_cleared(seen);
      sheet_cleared.clear_bit(static_cast<std::uint16_t>(1 << bit));
      ASSERT_EQ(cleared.clear_error(error), sheet_cleared.owner) << seen << " bit " << bit;
      ASSERT_EQ(look(cleared), sheet_cleared.now) << seen << " bit " << bit;
    }
  }
}

TEST_F(EveryFlownConfiguration, UpdateEqualsRaisingTheEventOfTheErrorWord) {
  for (const auto& [seen, machine] : all_) {
    StateMachine m = machine;
    const Actions owner = m.update();
    Sheet sheet(seen);
    sheet.event(seen.errors != 0 ? Event::kError : Event::kNoError, {});
    ASSERT_EQ(look(m), sheet.now) << seen;
    ASSERT_EQ(owner, sheet.owner) << seen;
  }
}

TEST_F(EveryConfiguration, EveryStateIsReachableAndNoOther) {
  std::set<State> states;
  for (const auto& [seen, machine] : all_) states.insert(seen.state);
  EXPECT_EQ(states, std::set<State>(kStates.begin(), kStates.end()));
}

TEST_F(EveryFlownConfiguration, EveryErrorWordIsMetWhereItCanBe) {
  std::map<State, std::set<std::uint16_t>> words;
  for (const auto& [seen, machine] : all_) words[seen.state].insert(seen.errors);
  EXPECT_EQ(words[State::kError].size(), 256u - 1) << "all but the empty word";
  EXPECT_EQ(words[State::kArmed].size(), 128u) << "errors never disarm; RC lost means failsafe";
  EXPECT_EQ(words[State::kFailsafe].size(), 128u);
  for (const std::uint16_t word : words[State::kArmed]) EXPECT_EQ(word & kRcLostBit, 0);
  for (const std::uint16_t word : words[State::kFailsafe]) EXPECT_NE(word & kRcLostBit, 0);
  EXPECT_EQ(words[State::kPreflight].count(0), 1u);
  for (const State state : {State::kCalibrating, State::kSaving, State::kMotorTest}) {
    EXPECT_EQ(words[state], std::set<std::uint16_t>{0}) << static_cast<int>(state);
  }
}

TEST_F(EveryFlownConfiguration, ArmedAndFailsafeBelongToTheirStates) {
  for (const auto& [seen, machine] : all_) {
    EXPECT_EQ(seen.armed, seen.state == State::kArmed || seen.state == State::kFailsafe) << seen;
    if (seen.state == State::kFailsafe) {
      EXPECT_TRUE(seen.failsafe) << seen;
    }
    if (seen.failsafe) {
      EXPECT_TRUE(seen.state == State::kFailsafe || seen.state == State::kError) << seen;
    }
  }
}

TEST_F(EveryFlownConfiguration, OnlyAnArmRequestOrWhatItWaitedForArms) {
  for (const auto& [seen, machine] : all_) {
    if (seen.armed) continue;
    for (const Event e : kEvents) {
      StateMachine m = machine;
      m.handle(e, {true, false, false});
      if (!m.armed()) continue;
      if (e == Event::kArmInAir) {
        EXPECT_EQ(seen.errors & 0x07, 0) << seen << " mixer, IMU, receiver";
        continue;
      }
      EXPECT_EQ(seen.errors, 0) << seen;
      EXPECT_TRUE(e == Event::kArm || e == Event::kCalibrationComplete || e == Event::kSaved)
          << seen;
    }
  }
}

TEST_F(EveryFlownConfiguration, NothingThatIsNotReadyArmsOnTheGround) {
  for (const auto& [seen, machine] : all_) {
    if (seen.armed) continue;
    for (const Event e : kEvents) {
      if (e == Event::kArmInAir) continue;
      for (const ArmRequest& r : all_requests()) {
        StateMachine m = machine;
        m.handle(e, r);
        EXPECT_TRUE(!m.armed() || (r.ready && !r.save)) << seen << " event " << static_cast<int>(e);
      }
    }
  }
}

TEST_F(EveryFlownConfiguration, ADisarmRequestIsARowOfEveryStateAndEndsArming) {
  for (const State state : kStates) {
    if (state == State::kInit) continue;  // no pilot yet
    EXPECT_TRUE(std::any_of(kTransitions.begin(), kTransitions.end(), [state](const Transition& t) {
      return t.state == state && t.event == Event::kDisarm;
    })) << static_cast<int>(state);
  }
  for (const auto& [seen, machine] : all_) {
    StateMachine m = machine;
    m.handle(Event::kDisarm);
    EXPECT_FALSE(m.armed()) << seen;
    EXPECT_FALSE(m.arming()) << seen;
  }
}

TEST_F(EveryConfiguration, OnlyADisarmRequestDisarms) {
  for (const auto& [seen, machine] : all_) {
    if (!seen.armed) continue;
    for (const Event e : kEvents) {
      StateMachine m = machine;
      m.handle(e);
      EXPECT_EQ(m.armed(), e != Event::kDisarm) << seen << " event " << static_cast<int>(e);
    }
    for (int bit = 0; bit < 8; ++bit) {
      StateMachine m = machine;
      m.set_error(static_cast<Error>(1 << bit));
      EXPECT_TRUE(m.armed()) << seen << " bit " << bit;
    }
  }
}

TEST(StateMachine, FailsafeFlagOutlivesADisarmUntilTheRadioIsBack) {
  StateMachine m;
  m.handle(Event::kInitialized);
  m.handle(Event::kArm);
  m.handle(Event::kRcLost);
  EXPECT_EQ(m.handle(Event::kDisarm) & action::kDisarm, action::kDisarm);
  EXPECT_EQ(m.state(), State::kError);
  EXPECT_TRUE(m.failsafe());
  m.handle(Event::kRcFound);
  EXPECT_FALSE(m.failsafe());
  EXPECT_EQ(m.state(), State::kPreflight);
}

TEST(StateMachine, ErrorDuringTheArmingCalibrationCancelsIt) {
  StateMachine m;
  m.handle(Event::kInitialized);
  EXPECT_EQ(m.handle(Event::kArm, {true, true, false}),
            action::kCalibrateGyro | action::kSendStatus);
  EXPECT_EQ(m.set_error(Error::kImuNotResponding), action::kStopCalibration | action::kSendStatus);
  m.clear_error(Error::kImuNotResponding);
  EXPECT_EQ(m.state(), State::kPreflight);
  m.handle(Event::kCalibrationComplete);
  EXPECT_FALSE(m.armed());
}

TEST(StateMachine, RowsOfOneStateAndEventStandTogether) {
  // handle() stops at the first row of another pair.
  std::set<std::pair<State, Event>> done;
  for (std::size_t k = 0; k < kTransitions.size(); ++k) {
    const std::pair pair{kTransitions[k].state, kTransitions[k].event};
    const bool same = k > 0 && kTransitions[k - 1].state == pair.first &&
                      kTransitions[k - 1].event == pair.second;
    if (!same) {
      EXPECT_TRUE(done.insert(pair).second) << "row " << k;
    }
  }
}

}  // namespace
}  // namespace rosflight::core
