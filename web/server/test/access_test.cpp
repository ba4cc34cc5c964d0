// SPDX-License-Identifier: BSD-3-Clause
// Who is served what, byte for byte: tokens, names, paths, limits.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "web/server/test/raw_client.hpp"
#include "web/server/web_server.hpp"

namespace rosflight::web::server {
namespace {

using namespace std::chrono_literals;

/// Another address of this computer stands for a network interface.
constexpr std::uint32_t kInterface = 0x7f000002;
constexpr const char* kInterfaceText = "127.0.0.2";
constexpr const char* kWebSocket =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n";

constexpr char kText = '\x81';
constexpr char kPing = '\x89';
constexpr char kPong = '\x8a';

/// One frame of a client, masked by zeros.
std::string frame(const std::string& text, char kind = kText) {
  std::string out{kind};
  const auto byte = [&out](std::size_t value) { out += static_cast<char>(value & 255U); };
  if (text.size() < 126) {
    byte(128U + text.size());
  } else if (text.size() < 65536) {
    byte(128U + 126U);
    for (const unsigned shift : {8U, 0U}) byte(text.size() >> shift);
  } else {
    byte(128U + 127U);
    for (unsigned k = 0; k < 8; ++k) byte(text.size() >> (56U - 8U * k));
  }
  return out + std::string(4, '\0') + text;
}

/// The contents of the last ping in frames of a server, which are not masked (RFC 6455, section 5.2).
std::string last_ping(const std::string& frames) {
  std::string ping;
  const auto byte = [&frames](std::size_t at) { return static_cast<unsigned char>(frames.at(at)); };
  for (std::size_t at = 0; at + 10 < frames.size();) {
    std::size_t length = byte(at + 1);
    std::size_t head = 2;
    if (const std::size_t words = length == 126 ? 2 : length == 127 ? 8 : 0; words != 0) {
      length = 0;
      for (; head < 2 + words; ++head) length = 256 * length + byte(at + head);
    }
    if (frames[at] == kPing) ping = frames.substr(at + head, length);
    at += head + length;
  }
  return ping;
}

class AccessTest : public testing::Test {
 protected:
  WebServer& start(const Access& access) {
    Contents contents{
        {}, {{"", "<p>page"}, {"page.js", "1"}, {"page.css", "a{}"}, {"offer.json", "{}"}}, &live_};
    server_ = std::make_unique<WebServer>(std::move(contents), access);
    address_ = access.listen.empty() ? INADDR_LOOPBACK : kInterface;
    host_ = (access.listen.empty() ? "127.0.0.1:" : "127.0.0.2:") + std::to_string(server_->port());
    return *server_;
  }
  Client connect() const { return Client(server_->port(), address_); }
  std::string head(const std::string& first, const std::string& more = "") const {
    return first + " HTTP/1.1\r\nHost: " + host_ + "\r\n" + more + "\r\n";
  }
  std::string ask(const std::string& first, const std::string& more = "") const {
    const Client client(server_->port(), address_);
    client.write(head(first, more + "Connection: close\r\n"));
    return client.read();
  }
  std::string status(const std::string& first, const std::string& more = "") const {
    return ask(first, more).substr(9, 3);
  }
  std::string upgrade_status(const std::string& origin) const {
    const Client client = connect();
    client.write(head("GET /", std::string(kWebSocket) + "Origin: " + origin + "\r\n"));
    return client.read_head().substr(9, 3);
  }
  std::string token() const { return server_->address().substr(server_->address().find('#') + 1); }
  std::string with_token(const std::string& token) const {
    return "Authorization: Bearer " + token + "\r\n";
  }

  LiveData live_;
  std::unique_ptr<WebServer> server_;
  std::uint32_t address_{INADDR_LOOPBACK};
  std::string host_;
};

TEST_F(AccessTest, OfAnotherComputerOnlyTheTokenOpensTheData) {
  start({0, kInterfaceText});
  EXPECT_EQ(status("GET /"), "200");
  EXPECT_EQ(status("GET /page.js"), "200");
  EXPECT_EQ(status("GET /page.css"), "200");
  EXPECT_EQ(status("GET /offer.json"), "401");
  EXPECT_EQ(status("GET /nothing"), "401") << "what there is, is not said either";
  EXPECT_EQ(status("GET /offer.json?token=" + token()), "401") << "never in a request line";
  std::string wrong = token();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& shown : {wrong, std::string(), token().substr(1), token() + "0"})
    EXPECT_EQ(status("GET /offer.json", with_token(shown)), "401") << shown;
  EXPECT_EQ(status("GET /offer.json", with_token(token())), "200");
}

TEST_F(AccessTest, ATokenHas128BitsAndIsNewWithEachStart) {
  const std::string first = start({0, kInterfaceText}).address();
  EXPECT_EQ(first.rfind("http://127.0.0.2:", 0), 0U);
  EXPECT_EQ(token().size(), 32U);
  EXPECT_EQ(token().find_first_not_of("0123456789abcdef"), std::string::npos);
  const std::string before = token();
  start({0, kInterfaceText});
  EXPECT_NE(token(), before);
  start({});
  EXPECT_EQ(server_->address().find('#'), std::string::npos);
}

TEST_F(AccessTest, ListensWhereItWasToldAlone) {
  start({0, kInterfaceText});
  EXPECT_THROW(Client(server_->port(), INADDR_LOOPBACK), std::system_error);
  start({});
  EXPECT_THROW(Client(server_->port(), kInterface), std::system_error);
}

TEST_F(AccessTest, AnotherNameIsMisdirected) {
  start({0, kInterfaceText});
  const std::string port = std::to_string(server_->port());
  for (const std::string& name :
       {"localhost:" + port, "127.0.0.1:" + port, std::string("127.0.0.2"),
        std::string("127.0.0.2:1"), "example.org:" + port, "127.0.0.2.example.org:" + port}) {
    host_ = name;
    EXPECT_EQ(status("GET /"), "421") << name;
  }
}

TEST_F(AccessTest, KnownApplicationsMayLookByAWebSocketAlone) {
  start({});
  for (const char* origin :
       {"https://app.foxglove.dev", "https://lichtblick-suite.github.io", "file://"}) {
    EXPECT_EQ(upgrade_status(origin), "101") << origin;
    EXPECT_EQ(status("GET /offer.json", std::string("Origin: ") + origin + "\r\n"), "403")
        << origin;
  }
  for (const char* origin : {"null", "", "https://example.org", "http://app.foxglove.dev",
                             "https://app.foxglove.dev:444", "https://app.foxglove.dev.example.org",
                             "https://example.org/https://app.foxglove.dev", "https://github.io",
                             "file:///home", "file://example.org"})
    EXPECT_EQ(upgrade_status(origin), "403") << origin;
}

TEST_F(AccessTest, AnOriginOfTheUsersChoiceMayLook) {
  Access access;
  access.origins = {"https://example.org"};
  start(access);
  EXPECT_EQ(upgrade_status("https://example.org"), "101");
  EXPECT_EQ(upgrade_status("https://app.foxglove.dev"), "101");
  EXPECT_EQ(upgrade_status("http://example.org"), "403");
  EXPECT_EQ(status("GET /offer.json", "Origin: https://example.org\r\n"), "403");
}

TEST_F(AccessTest, OfAnotherComputerNoApplicationIsAdmittedUnlessChosen) {
  Access access;
  access.listen = kInterfaceText;
  access.origins = {"https://example.org"};
  start(access);
  for (const std::string_view origin : Admission::kApplications)
    EXPECT_EQ(upgrade_status(std::string(origin)), "403") << origin;
  const Client client = connect();
  client.write(head("GET /", std::string(kWebSocket) + "Origin: https://example.org\r\n"));
  EXPECT_EQ(client.read_head().substr(9, 3), "101");
  client.write(frame(R"({"op":"subscribe","subscriptions":[]})"));  // in place of the token
  EXPECT_EQ(client.read_some(1), "");
}

TEST(Admission, AnOriginIsThatOfOneSite) {
  for (const char* origin : {"https://example.org", "http://127.0.0.1:8080", "http://[::1]:8080"})
    EXPECT_TRUE(Admission::is_origin_text(origin)) << origin;
  for (const char* text : {"", "null", "*", "example.org", "https://", "://example.org",
                           "https://*", "https://example.org/", "https://Example.org", "file://"})
    EXPECT_FALSE(Admission::is_origin_text(text)) << text;
}

TEST_F(AccessTest, NoAddressOfOneInterfaceIsRefused) {
  for (const char* listen :
       {"0.0.0.0", "::", "::ffff:127.0.0.1", "224.0.0.1", "example.org", "127.0.0", "127.0.0.1:80"})
    EXPECT_THROW(start({0, listen}), std::invalid_argument) << listen;
  EXPECT_THROW(start({0, "203.0.113.1"}), std::system_error);  // of nobody, RFC 5737
}

TEST_F(AccessTest, AWebSocketShowsTheTokenFirst) {
  start({0, kInterfaceText});
  const auto first_text = [this](const std::string& message) {
    const Client client(server_->port(), address_);
    client.write(head("GET /", kWebSocket));
    EXPECT_EQ(client.read_head().substr(9, 3), "101");
    client.write(frame(message));
    return client.read_some(1);
  };
  EXPECT_NE(first_text(R"({"op":"token","token":")" + token() + "\"}").find("serverInfo"),
            std::string::npos);
  std::string wrong = token();
  wrong.front() = wrong.front() == '0' ? '1' : '0';
  for (const std::string& message :
       {R"({"op":"token","token":")" + wrong + "\"}", std::string(R"({"op":"token"})"),
        std::string(R"({"op":"subscribe","subscriptions":[]})"), std::string("no JSON")}) {
    EXPECT_EQ(first_text(message), "") << message;
  }
}

TEST_F(AccessTest, AWebSocketThatShowsNoTokenIsLetGo) {
  start({0, kInterfaceText, 10s, 100ms});
  const Client client(server_->port(), address_);
  client.write(head("GET /", kWebSocket));
  const std::string said = client.read();  // returns, because the server closes
  EXPECT_EQ(said.find("serverInfo"), std::string::npos);
}

TEST_F(AccessTest, NoPathLeavesTheAddressesListed) {
  start({});
  for (const char* target :
       {"/../web_server.cpp", "/%2e%2e/etc/passwd", "//etc/passwd", "/page.js/..", "/./page.js",
        "/page.js%00", "/PAGE.JS", "/etc/passwd", "/page.js/"})
    EXPECT_EQ(status(std::string("GET ") + target), "404") << target;
  EXPECT_EQ(status("GET http://127.0.0.1/etc/passwd"), "400");
}

TEST_F(AccessTest, NothingIsChangedByARequest) {
  start({});
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"})
    EXPECT_EQ(status(std::string(method) + " /offer.json"), "405") << method;
}

TEST_F(AccessTest, ALongHeadAndABodyAreRefusedAndEndTheConnection) {
  start({});
  const Client head_client = connect();
  head_client.write("GET / HTTP/1.1\r\nHost: " + host_ +
                    "\r\nX: " + std::string(WebServer::kMaxHead, 'x'));
  EXPECT_EQ(head_client.read().substr(9, 3), "431");
  const Client body_client = connect();
  body_client.write(head("POST /", "Content-Length: 5\r\n") + "hello" + head("GET /"));
  const std::string answer = body_client.read();
  EXPECT_EQ(answer.substr(9, 3), "413");
  EXPECT_EQ(answer.find("<p>page"), std::string::npos);
}

TEST_F(AccessTest, AConnectionThatIsSilentIsClosed) {
  start({0, {}, 100ms});
  EXPECT_EQ(connect().read(), "");
  const Client half = connect();
  half.write("GET / HTTP/1.1\r\nHo");
  EXPECT_EQ(half.read(), "");
}

TEST_F(AccessTest, ATooLongMessageEndsTheWebSocket) {
  start({});
  const Client client = connect();
  client.write(head("GET /", kWebSocket));
  EXPECT_EQ(client.read_head().substr(9, 3), "101");
  client.write(frame(std::string(WebServer::kMaxMessage + 1, ' ')));
  const std::string said = client.read();
  const std::string too_big{'\x03', '\xf1'};  // 1009, RFC 6455 section 7.4.1
  EXPECT_NE(said.find(too_big), std::string::npos);
}

TEST_F(AccessTest, AMessageBeforeTheAnswerToTheHandshakeIsRefused) {
  start({});
  const Client client = connect();
  client.write(head("GET /", kWebSocket) + frame("{}"));
  EXPECT_EQ(client.read().substr(9, 3), "400");
}

TEST_F(AccessTest, ASlowReaderGetsAllOfIt) {
  const std::string much(std::size_t{32} << 20U, 'x');  // more than the sockets hold
  server_ = std::make_unique<WebServer>(Contents{{}, {{"", much}}}, Access{0, {}, 200ms});
  host_ = "127.0.0.1:" + std::to_string(server_->port());
  const Client client = connect();
  client.write(head("GET /", "Connection: close\r\n"));
  std::this_thread::sleep_for(400ms);
  EXPECT_GT(client.read().size(), much.size());
}

TEST_F(AccessTest, AViewerThatReadsLateSeesThePresent) {
  live_.add_channel({"/state", "std_msgs/msg/String", "string data", LiveData::Kind::kState});
  start({});
  const Client client = connect();
  client.write(head("GET /", kWebSocket));
  EXPECT_EQ(client.read_head().substr(9, 3), "101");
  EXPECT_NE(client.read_to("/state").find("advertise"), std::string::npos);
  client.write(frame(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1}]})"));
  constexpr std::size_t kSize = 8192;
  const auto put = [&](std::uint64_t time_ns) {
    live_.put(0, time_ns, std::vector<std::uint8_t>(kSize));
    std::this_thread::sleep_for(20ms);
  };
  for (std::uint64_t k = 0; k < 50; ++k) put(k);
  const std::string past = client.read_waiting();
  EXPECT_GT(past.size(), std::size_t{WebServer::kMaxOnTheWay});
  EXPECT_LT(past.size(), WebServer::kMaxOnTheWay + 2 * kSize);
  put(50);
  EXPECT_EQ(client.read_waiting(), "");
  client.write(frame(last_ping(past), kPong));
  client.write(frame("no number", kPong) + frame("99999999999", kPong));  // neither is of a ping
  const std::string present = client.read_some(kSize);
  constexpr std::size_t kHead = 4;  // of a frame of this size
  EXPECT_EQ(present.substr(kHead, 13), std::string("\x01\x07\0\0\0\x32\0\0\0\0\0\0\0", 13));
}

TEST_F(AccessTest, NoMoreThanItsViewersAreServed) {
  start({});
  std::vector<std::unique_ptr<Client>> viewers;
  for (int k = 0; k < WebServer::kMaxViewers; ++k) {
    viewers.push_back(std::make_unique<Client>(server_->port()));
    viewers.back()->write(head("GET /", kWebSocket));
    EXPECT_EQ(viewers.back()->read_head().substr(9, 3), "101");
  }
  const Client another = connect();
  another.write(head("GET /", kWebSocket));
  EXPECT_EQ(another.read_head().substr(9, 3), "503");
}

TEST_F(AccessTest, ThePageMayUseNothingOfOthers) {
  start({});
  const std::string answer = ask("GET /");
  const auto from = answer.find("Content-Security-Policy: ");
  EXPECT_EQ(
      answer.substr(from, answer.find("\r\n", from) - from),
      "Content-Security-Policy: default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; "
      "connect-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
}

}  // namespace
}  // namespace rosflight::web::server
