// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/web_server.hpp"

#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "web/server/admission.hpp"
#include "web/server/detail/http_session.hpp"

namespace rosflight::web::server {

struct WebServer::Impl {
  Impl(Contents contents, Access access) {
    site.contents = std::move(contents);
    site.access = std::move(access);
  }

  /// What is new goes to all viewers, again and again.
  void tick() {
    timer.expires_after(std::chrono::microseconds(1'000'000 / kRate_Hz));
    timer.async_wait([this](beast::error_code error) {
      if (error) return;
      for (const std::weak_ptr<Viewer>& weak : site.viewers) {
        if (const auto viewer = weak.lock()) viewer->send_next();
      }
      tick();
    });
  }

  /// @throws boost::system::system_error, which is a std::system_error.
  void listen(tcp::acceptor& acceptor, const asio::ip::address& address, std::uint16_t port) {
    const tcp::endpoint here(address, port);
    acceptor.open(here.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    if (address.is_v6()) acceptor.set_option(asio::ip::v6_only(true));
    acceptor.bind(here);
    acceptor.listen();
  }

  void accept(tcp::acceptor& acceptor) {
    acceptor.async_accept([this, &acceptor](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error && site.clients < kMaxClients) {
        std::make_shared<HttpSession>(std::move(socket), site)->read();
      }
      accept(acceptor);
    });
  }

  Site site;
  asio::io_context io{1};
  tcp::acceptor first{io};
  tcp::acceptor v6{io};  ///< Listens on the IPv6 loopback address.
  asio::steady_timer timer{io};
  std::thread thread;
};

WebServer::WebServer(Contents contents, Access access)
    : impl_{std::make_unique<Impl>(std::move(contents), std::move(access))} {
  Impl& impl = *impl_;
  const std::string& listen = impl.site.access.listen;
  beast::error_code error;
  const auto address = listen.empty() ? asio::ip::address(asio::ip::address_v4::loopback())
                                      : asio::ip::make_address(listen, error);
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  if (error || address.is_unspecified() || address.is_multicast() || mapped)
    throw std::invalid_argument(listen + " is no address of one network interface");
  try {
    impl.listen(impl.first, address, impl.site.access.port);
  } catch (const boost::system::system_error& refused) {
    throw std::system_error(refused.code().value(), std::system_category());
  }
  impl.site.admission =
      Admission(listen.empty() ? listen : address.to_string(), port(), impl.site.access.origins);
  impl.accept(impl.first);
  if (listen.empty()) {
    try {
      impl.listen(impl.v6, asio::ip::address_v6::loopback(), port());
      impl.accept(impl.v6);
    } catch (const boost::system::system_error&) {
      impl.v6.close();  // a computer without IPv6
    }
  }
  if (impl.site.contents.live != nullptr) impl.tick();
  impl.thread = std::thread([&impl] { impl.io.run(); });
}

WebServer::~WebServer() {
  impl_->io.stop();
  impl_->thread.join();
}

std::uint16_t WebServer::port() const {
  return impl_->first.local_endpoint().port();
}

std::string WebServer::address(Right right) const {
  return impl_->site.admission.address(right);
}

}  // namespace rosflight::web::server
