// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <utility>

#include "base/constants.hpp"
#include "messages/simulation.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/frames.hpp"
#include "rosflight_sim/holoocean_messages.hpp"
#include "viewer/holoocean/package.hpp"
#include "viewer/holoocean/visualiser.hpp"

namespace rosflight_sim {
namespace {

using namespace rosflight_common;

using std_srvs::srv::Trigger;
using tf2_msgs::msg::TFMessage;

/// Shows the truth in HoloOcean and publishes what its cameras and range finders measure, with the stamp of the truth that was
/// measured. The simulation never waits for it: a truth that the engine is too slow for is skipped.
class HoloOceanNode : public rclcpp::Node {
 public:
  explicit HoloOceanNode(const rclcpp::NodeOptions& options) : Node("holoocean_node", options) {
    const holoocean::Scenario scenario = declare_scenario();
    const auto engine = declare_engine(scenario);
    prefix_ = declare_text(*this, "frame_prefix", frame_prefix(get_namespace()),
                           "prefix of the names of frames");
    holoocean::check_available(engine);
    advertise(scenario);
    visualiser_ = std::make_unique<holoocean::Visualiser>(
        scenario, engine, holoocean::Visualiser::Pace::kSkip,
        holoocean::Visualiser::Receivers{[this](holoocean::SensorFrame&& frame) { publish(frame); },
                                         [this](const std::string& note) { report(note); }});
    truths_ = create_subscription<rosflight_msgs::msg::SimState>(
        "sim/truth_state", stream(10),
        [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) { show(*message); });
    reset_ = create_service<Trigger>(
        "holoocean/holoocean_reset",
        [this](const std::shared_ptr<Trigger::Request>,
               std::shared_ptr<Trigger::Response> response) { reset(*response); });
  }

 private:
  /// Publishers of one sensor; those that its kind does not have are empty.
  struct Outputs {
    holoocean::SensorSetup sensor;
    rclcpp::Publisher<rosflight_msgs::msg::RGBCamera>::SharedPtr reference_image;
    rclcpp::Publisher<rosflight_msgs::msg::RangeFinderSensor>::SharedPtr reference_ranges;
    rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr image;
    rclcpp::Publisher<sensor_msgs::msg::CameraInfo>::SharedPtr info;
    rclcpp::Publisher<sensor_msgs::msg::LaserScan>::SharedPtr scan;
  };

  holoocean::Scenario declare_scenario() {
    const std::string file = declare_text(*this, "scenario_file", "",
                                          "scenario file of HoloOcean; empty: package Land with "
                                          "the sensors of ROSflight 2.x");
    const std::string agent = declare_text(*this, "agent", "fixedwing",
                                           "body without scenario_file: fixedwing or multirotor");
    const std::string env = declare_text(*this, "env", "default",
                                         "world of the package without scenario_file; "
                                         "default: the one of this name, else its first");
    if (!file.empty()) return holoocean::read_scenario_file(file);
    if (agent != "fixedwing" && agent != "multirotor") {
      throw rosflight::config::Error("parameter agent: found '" + agent +
                                     "', allowed fixedwing or multirotor");
    }
    auto scenario = holoocean::default_scenario(
        agent == "fixedwing" ? holoocean::AgentType::kFixedWing : holoocean::AgentType::kUav);
    if (env != "default") scenario.world = env;
    return scenario;
  }

  holoocean::Engine::Options declare_engine(const holoocean::Scenario& scenario) {
    holoocean::Engine::Options engine;
    engine.window = declare_switch(*this, "show_viewport", true, "show the engine's window");
    const bool attach = declare_switch(*this, "attach", false,
                                       "attach to a running engine instead of starting one");
    if (!attach) engine.world = holoocean::find_world(scenario, holoocean::packages_folder());
    return engine;
  }

  void advertise(const holoocean::Scenario& scenario) {
    TFMessage frames;
    for (const holoocean::SensorSetup& sensor : scenario.sensors) {
      using holoocean::SensorType;
      const bool ranges = sensor.type == SensorType::kRangeFinder;
      if (!ranges && !holoocean::is_camera(sensor.type)) continue;
      Outputs& out = outputs_[sensor.name];
      const rclcpp::QoS qos(10);
      out.sensor = sensor;
      if (sensor.type == SensorType::kRgbCamera)
        out.reference_image = create_publisher<rosflight_msgs::msg::RGBCamera>(sensor.name, qos);
      if (ranges) {
        out.reference_ranges =
            create_publisher<rosflight_msgs::msg::RangeFinderSensor>(sensor.name, qos);
        if (is_plane(sensor))
          out.scan = create_publisher<sensor_msgs::msg::LaserScan>(sensor.name + "/scan", qos);
      } else {
        out.image = create_publisher<sensor_msgs::msg::Image>(sensor.name + "/image_raw", qos);
        out.info =
            create_publisher<sensor_msgs::msg::CameraInfo>(sensor.name + "/camera_info", qos);
      }
      for (auto& frame : sensor_frames(sensor, "base_link", prefix_))
        frames.transforms.push_back(std::move(frame));
    }
    fixed_ = create_latched_publisher<TFMessage>(*this, "/tf_static", 1);
    fixed_->publish(frames);
  }

  void show(const rosflight_msgs::msg::SimState& message) {
    if (!rosflight::messages::from_message(
            from_ros<rosflight::messages::rosflight_msgs::SimState>(message),
            rosflight::base::kStandardGravity_m_s2, truth_)) {
      return;
    }
    visualiser_->show(truth_.body, std::chrono::nanoseconds(nanoseconds(message.header.stamp)));
  }

  void reset(Trigger::Response& response) {
    const std::string failure = visualiser_->failure();
    response.success = failure.empty();
    response.message = failure.empty() ? "the level is loaded again with the next truth" : failure;
    if (failure.empty()) visualiser_->reset();
  }

  // The rest runs in the thread of the engine.

  void report(const std::string& note) const {
    if (note.rfind("warning: ", 0) == 0) {
      RCLCPP_WARN(get_logger(), "%s", note.c_str() + std::string("warning: ").size());
    } else {
      RCLCPP_INFO(get_logger(), "%s", note.c_str());
    }
  }

  void publish(const holoocean::SensorFrame& frame) {
    const std::int64_t stamp_ns = frame.time.count();
    for (const holoocean::Image& image : frame.images) publish(image, stamp_ns);
    for (const holoocean::Ranges& ranges : frame.ranges) publish(ranges, stamp_ns);
    if (!frame.in_contact) return;
    if (*frame.in_contact && !in_contact_) {
      RCLCPP_INFO(get_logger(), "contact at %.3f s",
                  std::chrono::duration<double>(frame.time).count());
    }
    in_contact_ = *frame.in_contact;
  }

  std_msgs::msg::Header header(const Outputs& out, std::int64_t stamp_ns) const {
    std_msgs::msg::Header header;
    header.stamp = stamp_of(stamp_ns);
    header.frame_id = measuring_frame(out.sensor, prefix_);
    return header;
  }

  void publish(const holoocean::Image& image, std::int64_t stamp_ns) {
    const Outputs& out = outputs_.at(image.sensor);
    if (out.reference_image) out.reference_image->publish(reference_image(image, stamp_ns));
    auto message = image_message(image);
    auto info = camera_info(image.width_px, image.height_px);
    message.header = info.header = header(out, stamp_ns);
    out.image->publish(message);
    out.info->publish(info);
  }

  void publish(const holoocean::Ranges& ranges, std::int64_t stamp_ns) {
    const Outputs& out = outputs_.at(ranges.sensor);
    out.reference_ranges->publish(reference_ranges(ranges, stamp_ns));
    if (!out.scan) return;
    auto scan = laser_scan(ranges);
    scan.header = header(out, stamp_ns);
    out.scan->publish(scan);
  }

  std::string prefix_;
  std::map<std::string, Outputs> outputs_;
  rclcpp::Publisher<TFMessage>::SharedPtr fixed_;
  sim::Truth truth_;
  bool in_contact_{false};
  rclcpp::Service<Trigger>::SharedPtr reset_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truths_;
  std::unique_ptr<holoocean::Visualiser> visualiser_;  ///< Ends first: it publishes.
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::HoloOceanNode, SingleThreadedExecutor)
