// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/mixer_setup.hpp"

#include "firmware/core/mixer_frames.hpp"

namespace rosflight::core {
namespace {

constexpr auto kFirstType = static_cast<std::uint16_t>(Param::kPriMixerOut0);
constexpr auto kFirstRate = static_cast<std::uint16_t>(Param::kPriMixerPwm0);
constexpr auto kFirstPrimary = static_cast<std::uint16_t>(Param::kPriMixer0_0);
constexpr auto kFirstSecondary = static_cast<std::uint16_t>(Param::kSecMixer0_0);
constexpr std::uint16_t kGainCount = kChannels * kAxes;
constexpr auto kEscCalibration = static_cast<std::int32_t>(MixerId::kEscCalibration);
constexpr float kDefaultRate_hz = 50.0f;

// Parameter PRI_MIXER_a_b is the gain from input a to channel b; the index runs fastest over a.
float& element(MixerGains& gains, std::uint16_t offset) {
  return gains(offset / static_cast<std::uint16_t>(kAxes),
               offset % static_cast<std::uint16_t>(kAxes));
}

void load_gains(const Parameters& parameters, std::uint16_t first, MixerGains& gains) {
  for (std::uint16_t k = 0; k < kGainCount; ++k) {
    element(gains, k) = parameters.get_float(static_cast<Param>(first + k));
  }
}

void save_gains(Parameters& parameters, std::uint16_t first, MixerGains& gains) {
  for (std::uint16_t k = 0; k < kGainCount; ++k) {
    static_cast<void>(parameters.set_float(static_cast<Param>(first + k), element(gains, k)));
  }
}

void load_header(const Parameters& parameters, MixerHeader& header) {
  for (std::uint16_t k = 0; k < kChannels; ++k) {
    header.type[k] =
        static_cast<OutputType>(parameters.get_int(static_cast<Param>(kFirstType + k)));
    header.rate_hz[k] = parameters.get_float(static_cast<Param>(kFirstRate + k));
  }
}

void save_header(Parameters& parameters, const MixerHeader& header) {
  for (std::uint16_t k = 0; k < kChannels; ++k) {
    static_cast<void>(parameters.set_int(static_cast<Param>(kFirstType + k),
                                         static_cast<std::int32_t>(header.type[k])));
    static_cast<void>(parameters.set_float(static_cast<Param>(kFirstRate + k), header.rate_hz[k]));
  }
}

void warn_about_choice(std::int32_t id, const Parameters& parameters, Log& log) {
  if (id == kEscCalibration) log.critical("ESC calibration mixer: stick drives all motors");
  if (id <= static_cast<std::int32_t>(MixerId::kX8)) {
    if (id != kEscCalibration && parameters.get_bool(Param::kUseMotorParam)) {
      log.warning(Text("Mixer ").add(id).add(" works without units,"));
      log.warning("but USE_MOTOR_PARAM wants newtons: use a custom one");
    }
    if (parameters.get_int(Param::kRcFAxis) != 2) {
      log.warning(Text("Mixer ").add(id).add(" takes throttle from axis 2,"));
      log.warning("but RC_F_AXIS is not 2: throttle would be lost");
    }
  } else if (parameters.get_int(Param::kRcFAxis) != 0) {
    log.warning(Text("Mixer ").add(id).add(" takes throttle from axis 0,"));
    log.warning("but RC_F_AXIS is not 0: throttle would be lost");
  }
}

void choose_secondary(Parameters& parameters, Mixer& mixer, Log& log) {
  const std::int32_t id = parameters.get_int(Param::kSecondaryMixer);
  if (is_predefined(id)) {
    log.info(Text("Secondary mixer ").add(id));
    if (id == kEscCalibration) log.critical("ESC calibration mixer as secondary");
    mixer.secondary() = frame_gains(static_cast<MixerId>(id));
  } else if (id == static_cast<std::int32_t>(MixerId::kCustom)) {
    log.info("Secondary mixer custom");
    load_gains(parameters, kFirstSecondary, mixer.secondary());
    return;
  } else {
    log.info("No secondary mixer, same as primary");
    mixer.secondary() = mixer.primary();
  }
  save_gains(parameters, kFirstSecondary, mixer.secondary());
}

}  // namespace

bool choose_mixers(Parameters& parameters, Mixer& mixer, Log& log) {
  const std::int32_t id = parameters.get_int(Param::kPrimaryMixer);
  MixerHeader header;
  load_header(parameters, header);
  load_gains(parameters, kFirstPrimary, mixer.primary());
  mixer.set_valid(true);
  if (is_predefined(id)) {
    log.info(Text("Primary mixer ").add(id));
    header = frame_header(static_cast<MixerId>(id));
    mixer.primary() = frame_gains(static_cast<MixerId>(id));
    save_header(parameters, header);
    save_gains(parameters, kFirstPrimary, mixer.primary());
    warn_about_choice(id, parameters, log);
  } else if (id == static_cast<std::int32_t>(MixerId::kCustom)) {
    log.info("Primary mixer custom");
  } else {
    log.error("No mixer: set PRIMARY_MIXER");
    mixer.set_valid(false);
    header.rate_hz.fill(kDefaultRate_hz);
  }
  mixer.set_header(header);
  choose_secondary(parameters, mixer, log);
  mixer.clear_outputs();
  return mixer.valid();
}

bool take_mixer_changes(const Parameters::ChangeSet& changed, Parameters& parameters,
                        Mixer& mixer) {
  const bool follows = parameters.get_int(Param::kSecondaryMixer) >= kFirstNoMixer;
  bool rates = false;
  for (std::uint16_t k = 0; k < kChannels; ++k) {
    rates = rates || changed[kFirstType + k] || changed[kFirstRate + k];
  }
  if (rates) {
    MixerHeader header;
    load_header(parameters, header);
    mixer.set_header(header);
  }
  for (std::uint16_t k = 0; k < kGainCount; ++k) {
    if (changed[kFirstPrimary + k]) {
      const float gain = parameters.get_float(static_cast<Param>(kFirstPrimary + k));
      element(mixer.primary(), k) = gain;
      if (follows) {
        static_cast<void>(parameters.set_float(static_cast<Param>(kFirstSecondary + k), gain));
        element(mixer.secondary(), k) = gain;
      }
    }
    if (changed[kFirstSecondary + k]) {
      element(mixer.secondary(), k) = parameters.get_float(static_cast<Param>(kFirstSecondary + k));
    }
  }
  return rates;
}

hal::OutputRates output_rates(const MixerHeader& header) {
  hal::OutputRates rates = header.rate_hz;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    if (!(rates[k] > 0.0f)) rates[k] = kDefaultRate_hz;
    if (header.type[k] == OutputType::kGpio) rates[k] = 0.0f;
  }
  return rates;
}

}  // namespace rosflight::core
