// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle/mixer_page.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::flight {
namespace {

using core::MixerId;

constexpr std::array<const char*, 11> kNames{
    "ESC calibration", "quad +", "quad X", "hex +",      "hex X",          "octo +",
    "octo X",          "Y6",     "X8",     "fixed wing", "inverted V-tail"};
constexpr std::array<const char*, 6> kAxes{"Fx", "Fy", "Fz", "roll", "pitch", "yaw"};
constexpr int kRoll = 3;
constexpr int kPitch = 4;
constexpr int kYaw = 5;
constexpr int kCell = 210;
constexpr int kColumns = 4;

/// "roll +0.5 yaw -0.25": what a channel does.
std::string effects(const core::MixerGains& gains, Eigen::Index channel) {
  std::string text;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const float gain = gains(channel, axis);
    if (gain == 0.0F) continue;
    text += fmt::format("{}{} {:+g}", text.empty() ? "" : ", ",
                        kAxes[static_cast<std::size_t>(axis)], gain);
  }
  return text;
}

const char* kind(core::OutputType type) {
  switch (type) {
    case core::OutputType::kServo:
      return "servo";
    case core::OutputType::kMotor:
      return "motor";
    case core::OutputType::kGpio:
      return "digital";
    case core::OutputType::kAux:
      break;
  }
  return "free";
}

/// A propeller of the given turning direction with the number of its channel.
std::string propeller(double x, double y, Eigen::Index channel, bool turns_left) {
  constexpr double kRadius = 17.0;
  const double ahead = turns_left ? -1.0 : 1.0;  // where the front of the disc moves
  return fmt::format(
      "<circle class=\"{0}\" cx=\"{1:.1f}\" cy=\"{2:.1f}\" r=\"{3}\"/>"
      "<path class=\"{0} tip\" d=\"M{4:.1f} {5:.1f} l{6:.1f} -6 l0 12 z\"/>"
      "<text x=\"{1:.1f}\" y=\"{7:.1f}\">{8}</text>\n",
      turns_left ? "left" : "right", x, y, kRadius, x + 7.0 * ahead, y - kRadius, -11.0 * ahead,
      y + 4.5, channel);
}

/// Motors where their roll and pitch gains say, further out where two share an arm.
std::string multirotor(const core::MixerGains& gains, const core::MixerHeader& header) {
  constexpr double kArm = 52.0;
  std::string arms;
  std::string motors;
  std::map<std::pair<long, long>, int> taken;
  for (Eigen::Index k = 0; k < Eigen::Index{core::kChannels}; ++k) {
    if (header.type[static_cast<std::size_t>(k)] != core::OutputType::kMotor) continue;
    const double right = -static_cast<double>(gains(k, kRoll));
    const double front = static_cast<double>(gains(k, kPitch));
    const double length = std::hypot(right, front);
    const double e_x = right / length;
    const double e_y = -front / length;
    int& earlier = taken[{std::lround(100 * e_x), std::lround(100 * e_y)}];
    const double radius = kArm + 28.0 * earlier++;
    const double x = radius * e_x;
    const double y = radius * e_y;
    arms += fmt::format("<path class=\"arm\" d=\"M0 0 L{:.1f} {:.1f}\"/>\n", x, y);
    motors += propeller(x, y, k, gains(k, kYaw) > 0.0F);
  }
  return arms + "<path class=\"body\" d=\"M0 -20 L12 12 L-12 12 z\"/>\n" + motors;
}

/// Outline of an aircraft and, below, what each channel does.
std::string aircraft(MixerId id, const core::MixerGains& gains, const core::MixerHeader& header) {
  std::string text =
      "<path class=\"body\" d=\"M-6 -68 L6 -68 L6 18 L-6 18 z M-80 -42 L80 -42 L80 -22 L-80 -22 "
      "z\"/>\n";
  text +=
      id == MixerId::kInvertedVTail
          ? "<path class=\"body\" d=\"M-4 18 L-34 4 L-34 -8 L4 8 z M4 18 L34 4 L34 -8 L-4 8 z\"/>\n"
          : "<path class=\"body\" d=\"M-30 4 L30 4 L30 16 L-30 16 z M-2 -8 L2 -8 L2 24 L-2 24 "
            "z\"/>\n";
  double y = 46.0;
  for (Eigen::Index k = 0; k < Eigen::Index{core::kChannels}; ++k) {
    const std::string does = effects(gains, k);
    if (does.empty()) continue;
    text += fmt::format("<text class=\"small\" x=\"0\" y=\"{}\">{} {}: {}</text>\n", y, k,
                        kind(header.type[static_cast<std::size_t>(k)]), does);
    y += 14.0;
  }
  return text;
}

std::string drawing(MixerId id) {
  const core::MixerGains gains = core::frame_gains(id);
  const core::MixerHeader header = core::frame_header(id);
  if (id == MixerId::kEscCalibration) {
    return "<text class=\"small\" x=\"0\" y=\"-10\">channels 0 to 9</text>\n"
           "<text class=\"small\" x=\"0\" y=\"6\">motor: " +
           effects(gains, 0) + "</text>\n";
  }
  const bool fixed_wing = id == MixerId::kFixedWing || id == MixerId::kInvertedVTail;
  return fixed_wing ? aircraft(id, gains, header) : multirotor(gains, header);
}

}  // namespace

std::string mixer_picture() {
  const int rows = static_cast<int>(kNames.size() + kColumns - 1) / kColumns;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\">\n"
      "<style>/* SPDX-License-Identifier: BSD-3-Clause */\n"
      "text {{font: 13px sans-serif; text-anchor: middle; fill: #1b2128}} .name {{font-weight: "
      "bold}}\n"
      ".small {{font-size: 11px}} .arm {{stroke: #8a94a0; stroke-width: 4}} .body {{fill: "
      "#c3cad2}}\n"
      "circle {{stroke-width: 2.5}} .left {{fill: #d8eaf6; stroke: #0072b2}}\n"
      ".right {{fill: #fbe0cf; stroke: #d55e00}} .tip.left {{fill: #0072b2}} .tip.right {{fill: "
      "#d55e00}}\n"
      "</style>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      kColumns * kCell, rows * kCell);
  for (std::size_t id = 0; id < kNames.size(); ++id) {
    const int x = static_cast<int>(id) % kColumns * kCell + kCell / 2;
    const int y = static_cast<int>(id) / kColumns * kCell;
    text += fmt::format(
        "<g transform=\"translate({} {})\">\n<text class=\"name\" x=\"0\" y=\"{}\">{} "
        "{}</text>\n{}</g>\n",
        x, y + kCell / 2 + 8, 22 - kCell / 2 - 8, id, kNames[id],
        drawing(static_cast<MixerId>(id)));
  }
  return text + "</svg>\n";
}

std::string mixer_tables() {
  std::string text =
      "| id | mixer | channel | output | rate [Hz] | gains |\n|---|---|---|---|---|---|\n";
  for (std::size_t id = 0; id < kNames.size(); ++id) {
    const core::MixerGains gains = core::frame_gains(static_cast<MixerId>(id));
    const core::MixerHeader header = core::frame_header(static_cast<MixerId>(id));
    for (std::size_t k = 0; k < core::kChannels; ++k) {
      const std::string does = effects(gains, static_cast<Eigen::Index>(k));
      if (does.empty()) continue;
      text += fmt::format("| {} | {} | {} | {} | {:g} | {} |\n", id, kNames[id], k,
                          kind(header.type[k]), header.rate_hz[k], does);
    }
  }
  return text;
}

}  // namespace rosflight::flight
