"""The kitchens behind the interfaces of other projects. `import remac_env` loads nothing of this."""
