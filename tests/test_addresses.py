"""Addresses of servers."""

from scenario_compiler.addresses import LOOPBACK, bracketed


def test_an_ipv6_address_is_in_brackets() -> None:
    assert [bracketed(host) for host in LOOPBACK] == ["127.0.0.1", "localhost", "[::1]"]
