"""What lcm-gen makes of our message types in Python, C and Java: each class can be imported, and
each message of a log is encoded again to the same bytes."""

import collections
import importlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "examples"))

import read_log  # noqa: E402

LCM_JAR = pathlib.Path("/usr/share/java/lcm.jar")
MIN_PER_CHANNEL = 20

C_PROGRAM = r"""
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
%(includes)s

static uint32_t big_endian(const uint8_t* b) {
  return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

#define TRY(channel_, type)                                              \
  if (strcmp(channel, channel_) == 0) {                                  \
    vpslam_##type message;                                               \
    if (vpslam_##type##_decode(data, 0, length, &message) < 0) return 0; \
    const int size = vpslam_##type##_encoded_size(&message);             \
    uint8_t* again = malloc(size);                                       \
    vpslam_##type##_encode(again, 0, size, &message);                    \
    const int same = size == length && memcmp(again, data, size) == 0;   \
    free(again);                                                         \
    vpslam_##type##_decode_cleanup(&message);                            \
    return same;                                                         \
  }

static int is_same(const char* channel, uint8_t* data, int length) {
  %(tries)s
  return 0;
}

int main(int argc, char** argv) {
  FILE* log = fopen(argv[1], "rb");
  uint8_t head[28];
  (void)argc;
  while (log && fread(head, 1, 28, log) == 28) {
    const int channel_length = big_endian(head + 20), length = big_endian(head + 24);
    char channel[64] = {0};
    uint8_t* data = malloc(length);
    if (fread(channel, 1, channel_length, log) != (size_t)channel_length) return 1;
    if (fread(data, 1, length, log) != (size_t)length) return 1;
    printf("%%s %%d\n", channel, is_same(channel, data, length));
    free(data);
  }
  return 0;
}
"""

JAVA_PROGRAM = """
import java.io.*;
import java.util.*;

public class Again {
  static byte[] again(String channel, byte[] data) throws IOException {
    lcm.lcm.LCMEncodable message;
    switch (channel) {
      %(cases)s
      default: throw new IOException(channel);
    }
    ByteArrayOutputStream out = new ByteArrayOutputStream();
    message.encode(new DataOutputStream(out));
    return out.toByteArray();
  }

  public static void main(String[] args) throws IOException {
    try (DataInputStream log = new DataInputStream(
             new BufferedInputStream(new FileInputStream(args[0])))) {
      while (log.available() > 0) {
        log.skipBytes(20);
        byte[] channel = new byte[log.readInt()];
        byte[] data = new byte[log.readInt()];
        log.readFully(channel);
        log.readFully(data);
        String name = new String(channel);
        System.out.println(name + " " + (Arrays.equals(again(name, data), data) ? 1 : 0));
      }
    }
  }
}
"""


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


class Bindings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="vpslam-bindings-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.log = cls.folder / "log.lcm"
        run(os.environ["VPSLAM_WRITE_RANDOM_LOG"], cls.log, MIN_PER_CHANNEL)
        cls.types = sorted((SOURCE / "lcmtypes").glob("*.lcm"))

    def assert_all_the_same(self, lines):
        """`lines`: channel, and whether its message came out the same."""
        good, bad = collections.Counter(), collections.Counter()
        for line in lines:
            channel, same = line.split()
            (good if same == "1" else bad)[channel] += 1
        self.assertEqual(bad, {})
        self.assertEqual(set(good), set(read_log.TYPES))
        self.assertGreaterEqual(min(good.values()), MIN_PER_CHANNEL)

    def test_python(self):
        run("lcm-gen", "--python", "--ppath", self.folder / "python", *self.types)
        sys.path.insert(0, str(self.folder / "python"))
        vpslam = importlib.import_module("vpslam")
        for path in self.types:
            self.assertTrue(hasattr(vpslam, path.stem), f"{path.stem} cannot be imported")
        lines = []
        for channel, data in read_log.events(self.log):
            message = getattr(vpslam, read_log.TYPES[channel]).decode(data)
            lines.append(f"{channel} {int(message.encode() == data)}")
            self.assertEqual(message.encode(), message.encode(), "nothing is used up by reading")
        self.assert_all_the_same(lines)

    def test_c(self):
        out = self.folder / "c"
        out.mkdir()
        run("lcm-gen", "--c", "--c-cpath", out, "--c-hpath", out, *self.types)
        (out / "again.c").write_text(C_PROGRAM % {
            "includes": "\n".join(f'#include "vpslam_{path.stem}.h"' for path in self.types),
            "tries": "\n".join(f'TRY("{channel}", {name})'
                               for channel, name in read_log.TYPES.items())})
        run("cc", "-o", out / "again", f"-I{out}", *out.glob("*.c"), "-llcm")
        self.assert_all_the_same(run(out / "again", self.log).splitlines())

    @unittest.skipUnless(shutil.which("javac") and LCM_JAR.exists(), "no JDK with LCM here")
    def test_java(self):
        out = self.folder / "java"
        out.mkdir()
        run("lcm-gen", "--java", "--jpath", out, *self.types)
        (out / "Again.java").write_text(JAVA_PROGRAM % {
            "cases": "\n".join(f'case "{channel}": message = new vpslam.{name}(data); break;'
                               for channel, name in read_log.TYPES.items())})
        run("javac", "-cp", f"{LCM_JAR}:{out}", "-d", out, out / "Again.java",
            *(out / "vpslam").glob("*.java"))
        said = run("java", "-Xmx256m", "-cp", f"{LCM_JAR}:{out}", "Again", self.log)
        self.assert_all_the_same(said.splitlines())

    def test_the_example_reads_a_log(self):
        run("lcm-gen", "--python", "--ppath", self.folder / "example", *self.types)
        done = subprocess.run(
            ["/usr/bin/python3", SOURCE / "examples" / "read_log.py", self.log,
             self.folder / "example"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("POSE", done.stderr)
        for line in done.stdout.splitlines():
            numbers = [float(word) for word in line.split()]
            self.assertEqual(len(numbers), 8)
            self.assertAlmostEqual(sum(q * q for q in numbers[4:]), 1, places=4)
        self.assertTrue(done.stdout)


if __name__ == "__main__":
    unittest.main()
