"""The include check finds what it should find, and nothing else."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools"))
import check_includes


class CheckIncludes(unittest.TestCase):
    def violations(self, files):
        """What is found in a tree of these files: path -> text."""
        with tempfile.TemporaryDirectory() as root:
            for path, text in files.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
                with open(os.path.join(root, path), "w") as file:
                    file.write(text)
            return list(check_includes.check_tree(root))

    def assert_taken(self, path, text):
        self.assertEqual(self.violations({path: text}), [])

    def assert_refused(self, path, text, reason):
        found = self.violations({path: text})
        self.assertEqual(len(found), 1, found)
        self.assertIn(reason, found[0])

    def test_arrows_point_one_way(self):
        self.assert_taken("src/cpu/a.cpp", '#include "src/scene/b.h"\n')
        self.assert_taken("src/io/a.cpp", '#include "src/optics/b.h"\n')
        self.assert_taken("src/mesh/a.cpp", '#include "src/mesh/b.h"\n#include "tetravox/mesh.h"\n')
        self.assert_refused("src/mesh/a.cpp", '#include "src/optics/b.h"\n', "src/mesh must not include")
        self.assert_refused("src/support/a.cpp", '#include "src/mesh/b.h"\n', "must not include")
        self.assert_refused("src/scene/a.cpp", '#include "src/cpu/b.h"\n', "must not include")
        self.assert_refused("src/scene/a.cpp", '#include "src/cpu/kernels/b.h"\n', "must not include")
        self.assert_refused("src/cpu/a.cpp", '#include "src/io/b.h"\n', "must not include")
        self.assert_refused("src/cpu/a.cpp", '#include "src/gl/b.h"\n', "must not include")

    def test_public_headers_stand_alone(self):
        header = "#pragma once\n"
        self.assert_taken("include/tetravox/a.h", header + '#include "tetravox/b.h"\n#include <vector>\n')
        self.assert_refused("include/tetravox/a.h", header + '#include "src/mesh/b.h"\n', "must not include")
        for foreign in ("vtkDataSet.h", "tbb/parallel_for.h", "hwy/highway.h", "nlohmann/json.hpp"):
            self.assert_refused("include/tetravox/a.h", header + f"#include <{foreign}>\n", "only in")

    def test_apps_see_the_public_api_and_themselves(self):
        self.assert_taken("apps/tool/a.cpp", '#include "tetravox/io.h"\n#include "apps/tool/b.h"\n')
        self.assert_refused("apps/tool/a.cpp", '#include "src/support/b.h"\n', "must not include")
        self.assert_refused("apps/tool/a.cpp", '#include "apps/viewer/b.h"\n', "must not include")

    def test_foreign_headers_have_a_home(self):
        self.assert_taken("src/io/a.cpp", "#include <vtkDataSet.h>\n")
        self.assert_taken("src/cpu/kernels/a.cpp", "#include <hwy/highway.h>\n")
        self.assert_refused("src/scene/a.cpp", "#include <vtkDataSet.h>\n", "only in src/io")
        self.assert_refused("src/cpu/a.cpp", "#include <hwy/highway.h>\n", "only in src/cpu/kernels")
        self.assert_refused("src/cpu/a.cpp", "#include <immintrin.h>\n", "only in src/cpu/kernels")
        self.assert_refused("src/cpu/a.cpp", "auto a = _mm256_add_ps(b, c);\n", "vector code")
        self.assert_refused("src/io/a.cpp", "#include <GL/gl.h>\n", "only in src/gl")

    def test_form_of_files(self):
        self.assert_refused("src/mesh/a.h", "int a();\n", "#pragma once")
        self.assert_refused("src/mesh/a.h", "#pragma once\nusing namespace std;\n", "using namespace")
        self.assert_refused("src/mesh/a.cpp", '#include "b.h"\n', "no full path")
        self.assert_refused("src/mesh/a.cpp", "\n" * 600, "stays under 600")
        self.assert_refused("src/mesh/a.h", "#pragma once\n" * 400, "stays under 400")
        self.assert_refused("src/new_folder/a.cpp", "", "has no rule")
        late = {"src/mesh/a.h": "#pragma once\n", "src/mesh/a.cpp": '#include <vector>\n#include "src/mesh/a.h"\n'}
        self.assertIn("own header", self.violations(late)[0])


if __name__ == "__main__":
    unittest.main()
