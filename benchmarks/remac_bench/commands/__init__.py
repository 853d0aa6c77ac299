"""The commands of `remac`, one file each."""
