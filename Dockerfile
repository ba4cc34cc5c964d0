# SPDX-License-Identifier: BSD-3-Clause
# For those who only want to look. Builds the Debian package and installs it into a small image:
#   docker build --tag rosflight .
#   docker run --rm --volume "$PWD:/flights" rosflight fly
FROM debian:12 AS build
COPY . /source
WORKDIR /source
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install --yes --no-install-recommends ca-certificates dpkg-dev \
 && ./rosflight fly --no-log --out /tmp/flight
WORKDIR /source/build/release
RUN cpack -G DEB -B /package

FROM debian:12-slim
COPY --from=build /package/*.deb /package/
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install --yes --no-install-recommends /package/*.deb \
 && rm -rf /var/lib/apt/lists/* /package
WORKDIR /flights
ENTRYPOINT ["rosflight"]
CMD ["fly"]
