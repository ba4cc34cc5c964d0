// SPDX-License-Identifier: BSD-3-Clause
#include "apps/view_command.hpp"

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <system_error>
#include <thread>

#include "apps/stop_signal.hpp"
#include "config/strict_yaml.hpp"
#include "flight/project_root.hpp"
#include "web/server/web_server.hpp"

namespace rosflight::apps {
namespace {

namespace fs = std::filesystem;
using web::server::Contents;

/// The folder with the page as it was built, or as an installation has it.
fs::path page_folder() {
  const fs::path root = flight::project_root();
  for (const fs::path& folder : {root / "build/web", root / "page"}) {
    if (fs::exists(folder / "index.html")) return folder;
  }
  throw config::Error("page: found none in " + (root / "build/web").string() +
                      ", allowed after ./rosflight view has built it");
}

Contents page() {
  const fs::path folder = page_folder();
  Contents contents;
  contents.files[""] = folder / "index.html";
  for (const char* name : {"page.js", "page.css"}) contents.files[name] = folder / name;
  return contents;
}

/// Adds the flight; the page learns from offer.json what there is.
void add_flight(const fs::path& input, Contents& contents) {
  const bool folder = fs::is_directory(input);
  const fs::path log = folder ? input / "flight.mcap" : input;
  if (!std::ifstream(log).good() || fs::is_directory(log)) {
    throw config::Error(log.string() +
                        ": found no file that can be read, allowed a flight folder with a log "
                        "(fly without --no-log) or a log (.mcap)");
  }
  // Texts may contain a file name that is no UTF-8.
  const auto text = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  nlohmann::json offer{{"log", "flight/flight.mcap"},
                       {"name", (folder ? fs::absolute(input).lexically_normal() : log).string()}};
  contents.files["flight/flight.mcap"] = log;
  if (folder && fs::exists(input / "summary.json")) {
    contents.files["flight/summary.json"] = input / "summary.json";
    offer["summary"] = "flight/summary.json";
  }
  contents.texts["offer.json"] = text(offer);
}

}  // namespace

int view_command(const ViewOptions& options, std::ostream& out) {
  Contents contents = page();
  add_flight(options.input, contents);
  try {
    const web::server::WebServer server(std::move(contents), options.port);
    const SignalWatch watch;
    out << server.address() << "  (Ctrl-C ends it)" << std::endl;
    constexpr auto kLook = std::chrono::milliseconds(50);
    while (stop_signal() == 0) std::this_thread::sleep_for(kLook);
  } catch (const std::system_error& error) {
    throw config::Error("--port: found " + std::to_string(options.port) + ", " +
                        error.code().message() + "; allowed a free port, or 0 for any");
  }
  return 0;
}

}  // namespace rosflight::apps
