// SPDX-License-Identifier: BSD-3-Clause
// The program of a node: all of it is in the node's library (rosflight_common/component.hpp).
extern "C" int rosflight_node_main(int argc, char** argv);

int main(int argc, char** argv) {
  return rosflight_node_main(argc, argv);
}
