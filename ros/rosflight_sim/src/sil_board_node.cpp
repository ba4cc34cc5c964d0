// SPDX-License-Identifier: BSD-3-Clause
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <memory>
#include <mutex>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/pwm_output.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <thread>

#include "messages/simulation.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/firmware_process.hpp"
#include "rosflight_sim/only_one.hpp"
#include "rosflight_sim/waiting_clock.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;
namespace hal = rosflight::hal;
namespace messages = rosflight::messages;
namespace boards = rosflight::boards;
namespace {

using namespace rosflight_common;
using messages::from_message;

namespace fs = std::filesystem;
using std_srvs::srv::Trigger;

/// Folder of the memory file: as given, or below the folder of ROS in the user's home. One sub-folder per namespace and
/// vehicle: two vehicles never share a memory, and none starts with the motor parameters of another.
fs::path memory_file(const std::string& folder, const std::string& name_space,
                     const std::string& vehicle_file) {
  fs::path base = folder;
  if (folder.empty()) {
    const char* ros_home = std::getenv("ROS_HOME");
    const char* home = std::getenv("HOME");
    base =
        ros_home != nullptr ? fs::path(ros_home) : fs::path(home != nullptr ? home : ".") / ".ros";
    base /= "rosflight_memory";
  }
  base /= fs::path(name_space).relative_path() / fs::path(vehicle_file).stem();
  std::error_code failed;
  fs::create_directories(base, failed);
  if (failed) {
    throw std::runtime_error("parameter memory_folder: found " + base.string() + " (" +
                             failed.message() + "), allowed a folder that can be made");
  }
  return base / "mem.bin";
}

base::LinkAddress udp(const std::string& host, std::int64_t port, std::int64_t own_port) {
  base::LinkAddress address;
  address.kind = base::LinkAddress::Kind::kUdp;
  address.host = host;
  address.port = static_cast<std::uint16_t>(port);
  address.local_port = static_cast<std::uint16_t>(own_port);
  return address;
}

/// The flight control unit: the real firmware, stepped by `sil_board/run`, with a UDP link to
/// `rosflight_io`. Passes of the main loop come from three sides: a step; an IMU sample that arrives
/// when the step of its time is over, for no other may come: time may be waiting for what the
/// companion makes of this sample; and bytes on the link, which a thread of its own waits for. A lock
/// lets one in at a time.
class SilBoardNode : public rclcpp::Node {
 public:
  explicit SilBoardNode(const rclcpp::NodeOptions& options)
      : Node("sil_board", options), only_one_{get_namespace()} {
    const std::string own_host = declare_text(*this, "simulation_host", "localhost",
                                              "own address of the link: localhost or 0.0.0.0");
    const auto own_port =
        declare_integer(*this, "simulation_port", 14525, 1, 65535, "own UDP port");
    const std::string far_host = declare_text(*this, "ROS_host", own_host, "host of rosflight_io");
    const auto far_port =
        declare_integer(*this, "ROS_port", 14520, 1, 65535, "UDP port of rosflight_io");
    const std::string folder =
        declare_text(*this, "memory_folder", "",
                     "folder of the non-volatile memory; empty: ~/.ros/rosflight_memory");
    simulated_time_ = get_parameter("use_sim_time").as_bool();
    const std::string vehicle = declare_text(
        *this, "vehicle_file", "", "vehicle file; its name becomes that of the memory's folder");
    const fs::path memory = memory_file(folder, get_namespace(), vehicle);
    firmware_ = std::make_unique<FirmwareProcess>(udp(far_host, far_port, own_port), memory,
                                                  [this] { return board_time(); });
    RCLCPP_INFO(get_logger(), "%s memory=%s%s", firmware_->serial().where().c_str(), memory.c_str(),
                firmware_->blank_memory() ? " (blank: default parameters)" : "");
    pwm_ = create_publisher<rosflight_msgs::msg::PwmOutput>("sim/pwm_output", newest());
    listen();
    if (!simulated_time_)
      report_ = create_wall_timer(std::chrono::seconds(1), [this] { report_stalls(); });
    run_ =
        create_service<Trigger>("sil_board/run", [this](std::shared_ptr<rclcpp::Service<Trigger>>,
                                                        std::shared_ptr<rmw_request_id_t> caller,
                                                        std::shared_ptr<Trigger::Request>) {
          asked_.push_back({std::move(caller), Wall::now()});
          step_when_due();
        });
    look_ = create_wall_timer(std::chrono::microseconds(100), [this] { step_when_due(); });
    look_->cancel();
    wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    link_ = std::thread([this] { serve_link(); });
  }

  ~SilBoardNode() override {
    stop_ = true;
    const std::uint64_t one = 1;
    static_cast<void>(::write(wake_, &one, sizeof one));
    link_.join();
    ::close(wake_);
  }

 private:
  using Wall = std::chrono::steady_clock;

  /// Who asked for a step of the board.
  struct Asked {
    std::shared_ptr<rmw_request_id_t> caller;
    Wall::time_point since;
  };

  hal::Time board_time() {
    if (!simulated_time_) return wall_time_.at(WaitingClock::Wall::now());
    constexpr std::int64_t kMicrosecond_ns = 1000;
    return hal::Time{now().nanoseconds() / kMicrosecond_ns};
  }

  /// Time since a stamp of node time; stamps of the future, and those that are older than a second
  /// (or were never set), count as now.
  hal::Time age(const builtin_interfaces::msg::Time& stamp) const {
    constexpr std::int64_t kMicrosecond_ns = 1000;
    constexpr hal::Time kOldest = hal::milliseconds(1000);
    const hal::Time age{(now().nanoseconds() - nanoseconds(stamp)) / kMicrosecond_ns};
    return age < hal::Time{0} || age > kOldest ? hal::Time{0} : age;
  }

  /// @tparam Message  the type of messages/ beside Ros.
  template <class Message, class Ros, class Sample>
  void subscribe(const std::string& topic) {
    subscriptions_.push_back(
        create_subscription<Ros>(topic, newest(), [this](typename Ros::ConstSharedPtr message) {
          Sample sample;
          from_message(from_ros<Message>(*message), sample);
          const std::lock_guard lock{mutex_};
          if constexpr (std::is_same_v<Sample, hal::RcFrame>)
            wall_time_.came(WaitingClock::Source::kReceiver, WaitingClock::Wall::now());
          firmware_->put(sample, age(message->header.stamp));
        }));
  }

  void listen() {
    subscriptions_.push_back(create_subscription<sensor_msgs::msg::Imu>(
        "sim/sensors/imu/data", newest(), [this](sensor_msgs::msg::Imu::ConstSharedPtr message) {
          hal::ImuSample sample;
          from_message(from_ros<messages::sensor_msgs::Imu>(*message), sample);
          const std::lock_guard lock{mutex_};
          sample.temperature_K = imu_temperature_K_;
          wall_time_.came(WaitingClock::Source::kImu, WaitingClock::Wall::now());
          firmware_->put(sample, age(message->header.stamp));
          if (simulated_time_ && now().nanoseconds() == last_step_ns_) pass();
        }));
    subscriptions_.push_back(create_subscription<sensor_msgs::msg::Temperature>(
        "sim/sensors/imu/temperature", newest(),
        [this](sensor_msgs::msg::Temperature::ConstSharedPtr message) {
          const std::lock_guard lock{mutex_};
          imu_temperature_K_ =
              messages::temperature_K(from_ros<messages::sensor_msgs::Temperature>(*message));
        }));
    subscribe<messages::sensor_msgs::MagneticField, sensor_msgs::msg::MagneticField,
              hal::MagSample>("sim/sensors/mag");
    subscribe<messages::rosflight_msgs::Barometer, rosflight_msgs::msg::Barometer, hal::BaroSample>(
        "sim/sensors/baro");
    subscribe<messages::rosflight_msgs::GNSS, rosflight_msgs::msg::GNSS, hal::GnssSample>(
        "sim/sensors/gnss");
    subscribe<messages::rosflight_msgs::Airspeed, rosflight_msgs::msg::Airspeed,
              hal::DiffPressureSample>("sim/sensors/diff_pressure");
    subscribe<messages::sensor_msgs::Range, sensor_msgs::msg::Range, hal::RangeSample>(
        "sim/sensors/range");
    subscribe<messages::rosflight_msgs::BatteryStatus, rosflight_msgs::msg::BatteryStatus,
              hal::BatterySample>("sim/sensors/battery");
    subscribe<messages::rosflight_msgs::RCRaw, rosflight_msgs::msg::RCRaw, hal::RcFrame>("sim/RC");
  }

  /// Simulated time and the wish for a step come on different ways, and the wish may be here first: the step belongs to a later moment
  /// than the one before. Steps by hand while time stands are taken after kMaxWait.
  void step_when_due() {
    constexpr auto kMaxWait = std::chrono::milliseconds(60);
    while (!asked_.empty()) {
      const bool stands = simulated_time_ && now().nanoseconds() == last_step_ns_;
      if (stands && Wall::now() - asked_.front().since < kMaxWait) {
        if (look_->is_canceled()) look_->reset();
        return;
      }
      step();
      Trigger::Response answer;
      answer.success = true;
      run_->send_response(*asked_.front().caller, answer);
      asked_.pop_front();
      if (!asked_.empty()) asked_.front().since = Wall::now();  // each waits for a time of its own
    }
    if (!look_->is_canceled()) look_->cancel();
  }

  void step() {
    last_step_ns_ = now().nanoseconds();
    rosflight_msgs::msg::PwmOutput message;
    {
      const std::lock_guard lock{mutex_};
      pass();
      message = to_ros<rosflight_msgs::msg::PwmOutput>(messages::to_message(firmware_->outputs()));
    }
    message.header.stamp = stamp_of(last_step_ns_);
    pwm_->publish(message);
  }

  void report_stalls() {
    constexpr hal::Time kWorthSaying = hal::milliseconds(20);
    WaitingClock::Stalls stalls{};
    {
      const std::lock_guard lock{mutex_};
      stalls = wall_time_.take_stalls();
    }
    if (stalls.sum > kWorthSaying)
      RCLCPP_WARN(get_logger(),
                  "board time stood still %d times, for %ld ms together: sensors came late",
                  stalls.count, static_cast<long>(hal::to_ms(stalls.sum)));
  }

  void pass() {
    const auto before = firmware_->restarts();
    firmware_->pass();
    if (firmware_->restarts() != before)
      RCLCPP_WARN(get_logger(), "the firmware has restarted (%lu)", firmware_->restarts());
  }

  void serve_link() {
    std::vector<pollfd> set;
    while (!stop_) {
      set.assign(1, {wake_, POLLIN, 0});
      {
        const std::lock_guard lock{mutex_};
        firmware_->serial().add_to(set);
      }
      constexpr int kMaxWait_ms = 100;
      if (::poll(set.data(), set.size(), kMaxWait_ms) <= 0 || stop_) continue;
      const std::lock_guard lock{mutex_};
      do {
        pass();
      } while (firmware_->serial().more());
    }
  }

  OnlyOne only_one_;
  bool simulated_time_{};
  std::int64_t last_step_ns_{-1};
  std::mutex mutex_;        ///< Protects the firmware and its inputs.
  WaitingClock wall_time_;  ///< Clock of the firmware without simulated time.
  std::unique_ptr<FirmwareProcess> firmware_;
  float imu_temperature_K_{298.15F};
  rclcpp::Publisher<rosflight_msgs::msg::PwmOutput>::SharedPtr pwm_;
  rclcpp::Service<Trigger>::SharedPtr run_;
  std::deque<Asked> asked_;            ///< Steps that wait for a new time.
  rclcpp::TimerBase::SharedPtr look_;  ///< While there are any.
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  rclcpp::TimerBase::SharedPtr report_;
  std::atomic<bool> stop_{false};
  int wake_{-1};
  std::thread link_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::SilBoardNode, SingleThreadedExecutor)
