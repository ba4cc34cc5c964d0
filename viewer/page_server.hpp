// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "web/server/web_server.hpp"

namespace rosflight::viewer {

/// The page itself, as it was built or as an installation has it.
/// @throws config::Error  there is none.
web::server::Contents page_contents();

/// @throws config::Error  the port is taken, the address is none of this computer, or an origin is none.
std::unique_ptr<web::server::WebServer> serve(web::server::Contents contents,
                                              const web::server::Access& access);

/// Returns when Ctrl-C or SIGTERM has come; a SignalWatch must live.
void wait_for_stop();

}  // namespace rosflight::viewer
