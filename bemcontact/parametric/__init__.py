"""How a contact state answers to what changes linearly: its derivative, its sensitivities, its path."""
