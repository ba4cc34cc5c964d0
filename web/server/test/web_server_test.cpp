// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/web_server.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <system_error>
#include <vector>

#include "web/server/test/raw_client.hpp"

namespace rosflight::web::server {
namespace {

class WebServerTest : public testing::Test {
 protected:
  WebServerTest() { std::ofstream(file_) << "0123456789"; }
  ~WebServerTest() override { std::filesystem::remove(file_); }

  /// The whole answer to a request with these lines; the connection is closed after it.
  std::string ask(const std::string& first_line, const std::string& more = "") const {
    const Client client(server_.port());
    client.write(first_line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server_.port()) +
                 "\r\nConnection: close\r\n" + more + "\r\n");
    return client.read();
  }
  static std::string status(const std::string& answer) { return answer.substr(9, 3); }
  static std::string body(const std::string& answer) {
    return answer.substr(answer.find("\r\n\r\n") + 4);
  }

  std::string port_text() const { return std::to_string(server_.port()); }

  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("web_server_test_" + std::to_string(::getpid()));
  WebServer server_{{{{"flight/flight.mcap", file_}}, {{"", "<p>page"}, {"offer.json", "{}"}}}};
};

TEST_F(WebServerTest, ServesWhatIsListed) {
  EXPECT_EQ(body(ask("GET /")), "<p>page");
  EXPECT_EQ(body(ask("GET /offer.json?x=1")), "{}");
  EXPECT_EQ(body(ask("GET /flight/flight.mcap")), "0123456789");
  EXPECT_NE(ask("GET /").find("Content-Type: text/html"), std::string::npos);
}

TEST_F(WebServerTest, ServesPartsOfFiles) {
  const std::string part = ask("GET /flight/flight.mcap", "Range: bytes=2-4\r\n");
  EXPECT_EQ(status(part), "206");
  EXPECT_EQ(body(part), "234");
  EXPECT_NE(part.find("Content-Range: bytes 2-4/10\r\n"), std::string::npos);
  EXPECT_EQ(status(ask("GET /flight/flight.mcap", "Range: bytes=10-\r\n")), "416");
}

TEST_F(WebServerTest, HeadHasNoBody) {
  const std::string answer = ask("HEAD /flight/flight.mcap");
  EXPECT_EQ(status(answer), "200");
  EXPECT_NE(answer.find("Content-Length: 10\r\n"), std::string::npos);
  EXPECT_EQ(body(answer), "");
}

TEST_F(WebServerTest, NothingElseIsThere) {
  for (const char* target : {"/flight", "/flight/", "/../../etc/passwd", "/%2e%2e/etc/passwd",
                             "//etc/passwd", "/flight/flight.mcap/..", "/index.html"}) {
    EXPECT_EQ(status(ask(std::string("GET ") + target)), "404") << target;
  }
  EXPECT_EQ(status(ask("GET http://127.0.0.1/")), "400");
  EXPECT_EQ(status(ask("POST /")), "405");
  EXPECT_EQ(status(ask("DELETE /flight/flight.mcap")), "405");
}

TEST_F(WebServerTest, AForeignNameIsMisdirected) {
  const auto with_host = [this](const std::string& host) {
    const Client client(server_.port());
    client.write("GET / HTTP/1.1\r\nConnection: close\r\n" + host + "\r\n");
    return status(client.read());
  };
  EXPECT_EQ(with_host("Host: localhost:" + port_text() + "\r\n"), "200");
  EXPECT_EQ(with_host("Host: [::1]:" + port_text() + "\r\n"), "200");
  EXPECT_EQ(with_host("Host: example.org:" + port_text() + "\r\n"), "421");
  EXPECT_EQ(with_host("Host: 127.0.0.1:1\r\n"), "421");
  EXPECT_EQ(with_host("Host: 127.0.0.1\r\n"), "421");
  EXPECT_EQ(with_host(""), "421");
}

TEST_F(WebServerTest, AForeignPageIsRefused) {
  const auto with_origin = [this](const std::string& origin) {
    return status(ask("GET /offer.json", "Origin: " + origin + "\r\n"));
  };
  EXPECT_EQ(with_origin("http://127.0.0.1:" + port_text()), "200");
  EXPECT_EQ(with_origin("http://localhost:" + port_text()), "200");
  for (const std::string& origin :
       {std::string("null"), std::string(""), "https://127.0.0.1:" + port_text(),
        "http://127.0.0.1:" + port_text() + ".example.org", std::string("http://example.org")}) {
    EXPECT_EQ(with_origin(origin), "403") << origin;
  }
}

TEST_F(WebServerTest, AnswersForbidForeignContents) {
  const std::string answer = ask("GET /");
  for (const char* header :
       {"Content-Security-Policy: default-src 'self'", "X-Content-Type-Options: nosniff",
        "Cross-Origin-Opener-Policy: same-origin"}) {
    EXPECT_NE(answer.find(header), std::string::npos) << header;
  }
}

TEST_F(WebServerTest, OneConnectionCarriesManyRequests) {
  const Client client(server_.port());
  const std::string here = " HTTP/1.1\r\nHost: 127.0.0.1:" + port_text() + "\r\n";
  client.write("GET /" + here + "\r\nGET /offer.json" + here + "Connection: close\r\n\r\n");
  const std::string both = client.read();
  EXPECT_NE(both.find("<p>page"), std::string::npos);
  EXPECT_TRUE(both.ends_with("{}"));
}

TEST_F(WebServerTest, TooLongAndBrokenRequestsEndTheConnection) {
  const Client too_long(server_.port());
  too_long.write("GET / HTTP/1.1\r\nX: " + std::string(WebServer::kMaxHead, 'x') + "\r\n\r\n");
  EXPECT_EQ(status(too_long.read()), "431");
  const Client broken(server_.port());
  broken.write("\x16\x03\x01 this is no HTTP\r\n\r\n");
  EXPECT_EQ(broken.read(), "");
  EXPECT_EQ(status(ask("GET /")), "200");
}

TEST_F(WebServerTest, AFileThatIsGoneIsNotFound) {
  std::filesystem::remove(file_);
  EXPECT_EQ(status(ask("GET /flight/flight.mcap")), "404");
}

TEST_F(WebServerTest, ATakenPortIsAnError) {
  EXPECT_THROW(WebServer({}, {server_.port(), {}}), std::system_error);
}

TEST_F(WebServerTest, NoMoreThanItsClientsAreServed) {
  std::vector<std::unique_ptr<Client>> clients;
  for (int k = 0; k < WebServer::kMaxClients; ++k) {
    clients.push_back(std::make_unique<Client>(server_.port()));
    clients.back()->write("GET / HTTP/1.1\r\n");  // goes on, so that it stays
  }
  const Client one_more(server_.port());
  EXPECT_EQ(one_more.read(), "");
}

TEST(WebServer, EndsWithOpenConnections) {
  auto server = std::make_unique<WebServer>(Contents{{}, {{"", "x"}}});
  const Client client(server->port());
  client.write("GET / HTTP/1.1\r\n");
  server.reset();
  EXPECT_EQ(client.read(), "");
}

}  // namespace
}  // namespace rosflight::web::server
