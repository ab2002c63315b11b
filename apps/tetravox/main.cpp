#include "apps/tetravox/tool.h"

int main(int argc, char** argv) { return tetravox::tool::run_tool(argc, argv); }
