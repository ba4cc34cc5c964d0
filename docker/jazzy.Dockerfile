# SPDX-License-Identifier: BSD-3-Clause
# ROS 2 Jazzy with RViz and all packages of ros/, built as ros/README.md says:
#   docker build --file docker/jazzy.Dockerfile --tag rosflight:jazzy .
#   docker run --rm --interactive --tty --network host rosflight:jazzy
FROM osrf/ros:jazzy-desktop
SHELL ["/bin/bash", "-o", "pipefail", "-c"]
COPY . /source
WORKDIR /source
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install --yes --no-install-recommends python3-venv \
 && rosdep update --rosdistro jazzy \
 && rosdep install --rosdistro jazzy --from-paths . ros --ignore-src --default-yes \
 && tools/ready.sh packages run \
 && rm -rf /var/lib/apt/lists/*
RUN tools/ready.sh build release rosflight_libraries \
 && source /opt/ros/jazzy/setup.bash \
 && export CMAKE_PREFIX_PATH="/source/build/release:$CMAKE_PREFIX_PATH" \
 && colcon build --base-paths ros --merge-install --install-base /opt/rosflight --executor sequential \
      --cmake-args -DBUILD_TESTING=OFF \
 && echo "source /opt/rosflight/setup.bash" >> /etc/bash.bashrc
WORKDIR /flights
CMD ["bash"]
