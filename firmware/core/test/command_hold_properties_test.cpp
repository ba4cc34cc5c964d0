// SPDX-License-Identifier: BSD-3-Clause
// The promises of OFFBOARD_HOLD over random flights of a vehicle that lifts off and lands by its thrust.
#include <algorithm>

#include "firmware/core/test/command_rig.hpp"
#include "firmware/core/test/random.hpp"

namespace rosflight::core {
namespace {

/// A vehicle that moves up and down by its thrust, 0 to 1 of the throttle, with a companion that climbs,
/// descends, lands, falls silent and comes back, a pilot, and a receiver.
class World {
 public:
  explicit World(std::uint64_t seed) : random_{seed} {
    hover_ = random_.uniform(0.3f, 0.7f);
    config_.failsafe_throttle = hover_ * random_.uniform(0.85f, 0.99f);
    config_.offboard_hold = milliseconds(random_.between(1, 2000));
    config_.offboard_timeout = milliseconds(random_.between(30, 300));
    config_.take_min_throttle = random_.chance(0.3f);
    config_.companion_in_failsafe = random_.chance(0.5f);
    command_.configure(config_);
  }

  void step() {
    now_ += kStep;
    arm_or_disarm();
    companion();
    const bool frame = now_.count() % kFrame.count() == 0;
    if (frame) pilot();
    command_.update(now_, pilot_, frame && !failsafe_, failsafe_);
    move();
    check();
  }
  int holds() const { return holds_; }
  int gaps_in_the_air() const { return gaps_in_the_air_; }

 private:
  static constexpr Time kStep = hal::microseconds(2500);
  static constexpr float kStep_s = 2.5e-3f;
  static constexpr Time kFrame = milliseconds(20);

  /// Once per `mean` on average, if asked every `period`.
  bool happens(Time mean, Time period = kStep) {
    return random_.chance(static_cast<float>(period.count()) / static_cast<float>(mean.count()));
  }

  void arm_or_disarm() {
    if (!armed_ && happens(milliseconds(500))) {
      const bool in_air = height_m_ > 0.0f;
      armed_ = true;
      lifted_ = in_air;
      pilot_.throttle = in_air ? pilot_.throttle : 0.0f;
      if (!in_air) {
        command_.forget_offboard();
        throttle_ = 0.0f;
        lands_ = true;
      }
      command_.arm(now_, in_air);
    } else if (armed_ && happens(milliseconds(20'000))) {
      armed_ = false;
      command_.disarm();
    }
  }

  /// Thrust for a vertical speed; on the ground it lets go within a second, as guidance does.
  void companion() {
    if (happens(milliseconds(2500))) lands_ = random_.chance(0.4f);
    if (happens(milliseconds(1500))) climb_m_s_ = random_.uniform(-1.5f, 1.5f);
    const float wanted_m_s = lands_ ? -1.0f : (lifted_ ? climb_m_s_ : 1.0f);
    const bool lets_go = lands_ && height_m_ == 0.0f;
    throttle_ = lets_go ? std::max(throttle_ - hover_ * kStep_s, 0.0f)
                        : hover_ * (1.0f + 0.3f * (wanted_m_s - speed_m_s_));
    throttle_ = std::clamp(throttle_, lets_go ? 0.0f : 0.4f * hover_, 1.0f);
    if (now_ >= silent_until_ && happens(milliseconds(1500))) {
      silent_until_ = now_ + milliseconds(random_.between(20, 3000));
    }
    if (now_ < silent_until_ || now_.count() % 10'000 != 0) return;
    const auto mode = static_cast<std::uint8_t>(random_.below(3));
    for (std::size_t k = 3; k < 6; ++k) u_[k] = random_.uniform(-0.3f, 0.3f);
    u_[2] = throttle_;
    ASSERT_TRUE(command_.set_offboard(now_, {mode, 0, u_}, throttle_ * config_.max_throttle));
    last_ = now_;
  }

  /// Idle, or more than it takes to hover: never for long between FAILSAFE_THR and hover on the ground.
  void pilot() {
    if (happens(milliseconds(3000), kFrame)) failsafe_ = !failsafe_ && random_.chance(0.5f);
    failsafe_ = failsafe_ && armed_;
    if (failsafe_) return;
    if (happens(milliseconds(1000), kFrame)) {
      pilot_.throttle = random_.chance(0.7f) ? 0.0f : 1.05f * hover_;
    }
    for (float* stick : {&pilot_.roll, &pilot_.pitch, &pilot_.yaw}) {
      if (!happens(milliseconds(1000), kFrame)) continue;
      *stick = random_.chance(0.8f) ? 0.0f : random_.uniform(-1.0f, 1.0f);
    }
    for (const Switch s : {Switch::kAttitudeOverride, Switch::kThrottleOverride}) {
      if (!happens(milliseconds(2000), kFrame)) continue;
      pilot_.on[static_cast<std::size_t>(s)] = random_.chance(0.2f);
    }
  }

  void move() {
    const float throttle = armed_ ? command_.combined().value[2] : 0.0f;
    constexpr float kLag_s = 0.05f, kDrag_1_s = 0.3f;
    thrust_ += (throttle / hover_ - thrust_) * kStep_s / kLag_s;
    speed_m_s_ += (9.8f * (thrust_ - 1.0f) - kDrag_1_s * speed_m_s_) * kStep_s;
    height_m_ += speed_m_s_ * kStep_s;
    if (height_m_ <= 0.0f) height_m_ = speed_m_s_ = 0.0f;
    lifted_ = lifted_ || height_m_ > 0.0f;
  }

  void check() {
    const Time silent = now_ - last_;
    const bool holds = silent > config_.offboard_timeout && command_.offboard_active();
    if (silent > config_.offboard_timeout && failsafe_) {
      EXPECT_TRUE(command_.in_failsafe()) << "the failsafe command";
      EXPECT_EQ(command_.combined().value[2], config_.failsafe_throttle);
    }
    if (holds) check_hold(silent);
    gaps_in_the_air_ += !holds && held_ && height_m_ > 0.0f ? 1 : 0;
    if (holds && !held_) {
      ++holds_;
      began_on_the_ground_ = height_m_ == 0.0f;
    }
    held_ = holds;
  }

  void check_hold(Time silent) {
    EXPECT_LE(silent, config_.offboard_timeout + config_.offboard_hold);
    EXPECT_TRUE(armed_) << "motors turn";
    EXPECT_FALSE(failsafe_);
    EXPECT_TRUE(lifted_) << "it has lifted off since it was armed";
    // What begins between a touchdown and the companion's letting go lifts nothing, unless it takes off again.
    began_on_the_ground_ = began_on_the_ground_ && !pilots(2);
    EXPECT_TRUE(!held_ || !began_on_the_ground_ || height_m_ == 0.0f || u_[2] > hover_);
    EXPECT_GT(u_[2], 0.5f * config_.failsafe_throttle);
    const auto& value = command_.combined().value;
    EXPECT_EQ(value[2], pilots(2) ? pilot_.throttle : u_[2]);
    const std::array<float, 3> sticks{pilot_.roll, pilot_.pitch, pilot_.yaw};
    for (std::size_t k = 3; k < 6; ++k) {
      const bool moved = std::abs(sticks[k - 3]) > config_.stick_deviation ||
                         pilot_.is_on(Switch::kAttitudeOverride);
      EXPECT_TRUE(pilots(k) || !moved) << "what the pilot moves is his, axis " << k;
      EXPECT_TRUE(pilots(k) || value[k] == 0.0f) << "level, axis " << k;
    }
    const bool less = config_.take_min_throttle && pilot_.throttle < u_[2];
    EXPECT_TRUE(pilots(2) || !(less || pilot_.is_on(Switch::kThrottleOverride)));
  }
  bool pilots(std::size_t axis) const {
    return (static_cast<unsigned>(command_.primary_axes()) >> axis & 1u) != 0;
  }

  Random random_;
  CommandManager command_;
  CommandManager::Config config_;
  PilotInput pilot_{};
  std::array<float, kAxes> u_{};
  Time now_{milliseconds(10'000)}, last_{}, silent_until_{};
  float hover_{}, throttle_{0.0f}, thrust_{0.0f}, speed_m_s_{0.0f}, height_m_{0.0f};
  float climb_m_s_{0.0f};
  bool armed_{false}, failsafe_{false}, lands_{true}, lifted_{false};
  bool held_{false}, began_on_the_ground_{false};
  int holds_{0}, gaps_in_the_air_{0};
};

TEST(OffboardHoldProperty, NeitherLongerNorOnTheGroundNorOverFailsafeOrPilot) {
  int holds = 0;
  int in_the_air = 0;
  for (std::uint64_t seed = 1; seed <= 400 && !::testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    World world{seed};
    for (int k = 0; k < 24'000 && !::testing::Test::HasFailure(); ++k) world.step();  // a minute
    holds += world.holds();
    in_the_air += world.gaps_in_the_air();
  }
  EXPECT_GT(holds, 1000);
  EXPECT_GT(in_the_air, 400) << "holds that ended in the air";
}

}  // namespace
}  // namespace rosflight::core
