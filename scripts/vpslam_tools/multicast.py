"""LCM over udpm needs multicast on this host: a free port for a graph, and a route.

With ttl=0 nothing leaves the host, whichever device the route names. So a default route does (the
kernel loops multicast back to local members), and only a host without any route for 239.255.76.67
needs one. Instead of guessing from the routing table, one datagram is sent and awaited.
"""

import ipaddress
import os
import re
import shutil
import socket
import struct
import subprocess

from vpslam_tools.errors import UserError

GROUP, DEFAULT_PORT = "239.255.76.67", "7667"  # LCM's own
REPAIR = [["ip", "link", "set", "lo", "up"], ["ip", "route", "add", "224.0.0.0/4", "dev", "lo"]]


def free_url():
    """A URL whose port nobody has: udpm receives every group of its port, so that graphs are kept
    apart by ports."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return f"udpm://{GROUP}:{probe.getsockname()[1]}?ttl=0"


def port(url):
    """Of an LCM URL; a URL without one means LCM's default, one of another kind itself."""
    network, _, address = url.partition("://")
    if network != "udpm":
        return url
    return address.partition("?")[0].partition(":")[2] or DEFAULT_PORT


def check_url(url):
    """A graph's processes have to reach each other over `url`."""
    if not url.startswith("udpm://"):
        raise UserError(f"--url {url}: reaches no other process; a graph needs udpm://, such as "
                        f"udpm://{GROUP}:{DEFAULT_PORT}")
    host = re.split(r"[:?/]", url[len("udpm://"):])[0]
    try:
        is_multicast = not host or ipaddress.IPv4Address(host).is_multicast
    except ValueError:
        is_multicast = False
    if not is_multicast:
        raise UserError(f"--url {url}: {host} is no multicast address; take one of 224.0.0.0 to "
                        f"239.255.255.255, such as {GROUP}")


def ensure_multicast():
    """Makes sure that multicast reaches this host; root adds a route on loopback where it does
    not, others are told the command."""
    fault = loopback_fault()
    if fault is None:
        return
    commands = " && ".join(" ".join(command) for command in REPAIR)
    if os.geteuid() != 0 or not shutil.which("ip"):
        raise UserError(f"multicast does not reach this host ({fault}); type: sudo sh -c "
                        f"'{commands}'")
    print(f"no multicast route ({fault}): {commands}", flush=True)
    for command in REPAIR:
        subprocess.run(command)
    fault = loopback_fault()
    if fault is not None:
        raise UserError(f"multicast does not reach this host ({fault}), with a route neither; does "
                        "a firewall drop UDP to 224.0.0.0/4?")


def loopback_fault():
    """None if a datagram sent to the group comes back, else why not."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.settimeout(1.0)
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            probe.bind(("", 0))
            membership = socket.inet_aton(GROUP) + struct.pack("=I", socket.INADDR_ANY)
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            token = os.urandom(16)
            probe.sendto(token, (GROUP, probe.getsockname()[1]))
            while probe.recv(64) != token:
                pass
    except socket.timeout:
        return "a datagram did not come back"
    except OSError as error:
        return error.strerror
    return None
