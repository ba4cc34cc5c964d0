// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/page_server.hpp"

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "base/stop_signal.hpp"
#include "config/strict_yaml.hpp"
#include "flight/project_root.hpp"

namespace rosflight::viewer {
namespace {

std::filesystem::path page_folder() {
  const std::filesystem::path root = flight::project_root();
  for (const std::filesystem::path& folder : {root / "build/web", root / "page"}) {
    if (std::filesystem::exists(folder / "index.html")) return folder;
  }
  throw config::Error("page: found none in " + (root / "build/web").string() +
                      ", allowed after ./rosflight view has built it");
}

}  // namespace

web::server::Contents page_contents() {
  const std::filesystem::path folder = page_folder();
  web::server::Contents contents;
  contents.files[""] = folder / "index.html";
  for (const char* name : {"page.js", "page.css"}) contents.files[name] = folder / name;
  return contents;
}

std::unique_ptr<web::server::WebServer> serve(web::server::Contents contents,
                                              const web::server::Access& access) {
  for (const std::string& origin : access.origins) {
    if (!web::server::Admission::is_origin_text(origin)) {
      throw config::Error("--allow-origin: found " + origin +
                          ", allowed SCHEME://HOST[:PORT] as browsers send it, such as "
                          "https://example.org");
    }
  }
  try {
    return std::make_unique<web::server::WebServer>(std::move(contents), access);
  } catch (const std::invalid_argument&) {
    throw config::Error("--listen: found " + access.listen +
                        ", allowed the address of one network interface, such as 192.168.0.7");
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::address_not_available) {
      throw config::Error("--listen: found " + access.listen +
                          ", allowed an address of this computer");
    }
    throw config::Error("--port: found " + std::to_string(access.port) + ", " +
                        error.code().message() + "; allowed a free port, or 0 for any");
  }
}

void wait_for_stop() {
  constexpr auto kLook = std::chrono::milliseconds(50);
  while (base::stop_signal() == 0) std::this_thread::sleep_for(kLook);
}

}  // namespace rosflight::viewer
