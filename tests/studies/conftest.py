"""Tests of studies are collected where the studies are; the product has its own without them."""

from reliab.core.shipped import find_shipped_folder

collect_ignore_glob = [] if find_shipped_folder("studies").is_dir() else ["*"]
